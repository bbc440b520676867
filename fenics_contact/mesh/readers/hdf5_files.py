"""HDF5 files, which must hold their data themselves: others that they name would be opened."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fenics_contact.mesh.geometry.process_room import RefusedError


def require_whole(where: str, path: Path) -> None:
    """Refuse a file that cannot be read, or that refers to another one.

    Args:
        where: What begins a message.
        path: The file.
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            outside = _outside(h5py, file)
            file.visititems(lambda name, found: outside.extend(_outside(h5py, found)))
    except (OSError, RuntimeError, ValueError) as error:
        said = " ".join(str(error).split())
        raise RefusedError(f"{where}: is no sound HDF5 file ({said})") from None
    if outside:
        raise RefusedError(
            f"{where}: '{outside[0]}' in it refers to another file, which a mesh may not; write "
            "all into one file"
        )


def _outside(h5py: Any, found: Any) -> list[str]:
    """Return the parts of a group or a data set that are kept in another file."""
    if isinstance(found, h5py.Dataset):
        return [found.name] if found.external or found.is_virtual else []
    links = {name: found.get(name, getlink=True) for name in found}
    own = (h5py.HardLink, h5py.SoftLink)
    return [f"{found.name}/{name}" for name, link in links.items() if not isinstance(link, own)]
