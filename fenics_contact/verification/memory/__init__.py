"""What the program says of memory, beside what runs take: bodies of many sizes and contacts."""
