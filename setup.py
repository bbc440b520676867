"""What pyproject.toml cannot say: every package, and meshes where there is no repository."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["fenics_contact*"]), "fenics_contact.meshes"],
    package_dir={"fenics_contact.meshes": "meshes"},
)
