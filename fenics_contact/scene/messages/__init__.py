"""Messages on what is wrong with a scene, in one sentence: its TOML, its keys, its values.

``validation`` words what pydantic found, ``toml_slips`` what tomllib did;
``usual_names`` knows what engineers call things.
"""

from fenics_contact.scene.messages.validation import sentence as sentence
from fenics_contact.scene.messages.validation import written as written
