"""Parts of messages that several commands share: suggestions of what a word was meant to be."""
