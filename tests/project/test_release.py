"""How versions are released, installed and published: scripts, recipes and workflows."""

import datetime
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.scenes import ROOT

pytestmark = pytest.mark.serial

SCRIPTS = ROOT / "distribution"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# Of PyPI → of conda-forge, where they differ.
CONDA = {
    "dolfinx-solver-real": "fenics-dolfinx",
    "gmsh": "python-gmsh",
    "matplotlib": "matplotlib-base",
}
# Which dolfinx there may be, README.md says; what the wheel of it brings conda has by names.
BESIDES = {"python", "fenics-dolfinx", "petsc", "c-compiler"}
AUTHOR = ("-c", "user.name=Test", "-c", "user.email=test@example.org")


def git(folder, *arguments):
    command = ["git", *AUTHOR, *arguments]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


@pytest.fixture
def checkout(tmp_path):
    """A repository with what bears the version."""
    if shutil.which("git") is None:
        pytest.skip("there is no git, as in the image")
    root = tmp_path / "checkout"
    for name in [*release().PLACES, "CHANGELOG.md", ".gitignore"]:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes((ROOT / name).read_bytes())
    git(tmp_path, "init", "--quiet", "--initial-branch=main", str(root))
    git(root, "config", "user.name", "Test")
    git(root, "config", "user.email", "test@example.org")
    git(root, "add", "--all")
    git(root, "commit", "--quiet", "-m", "All")
    return root


def script(name):
    sys.path.insert(0, str(SCRIPTS))
    try:
        return __import__(name)
    finally:
        sys.path.remove(str(SCRIPTS))


def release():
    return script("release")


def test_a_release_writes_its_version_everywhere(checkout):
    new = release().texts(checkout, "0.9.0", datetime.date(2030, 1, 2))
    assert set(new) == {*release().PLACES, "CHANGELOG.md"}
    for name, text in new.items():
        assert "0.9.0" in text and "0.1.0" not in text, name
    assert "## 0.9.0 (2030-01-02)" in new["CHANGELOG.md"]


@pytest.mark.parametrize(
    ("version", "before", "said"),
    [
        ("new", "", "'new' is no version"),
        ("0.9.0", "README.md", "not committed"),
        ("0.0.9", "", "not newer than 0.1.0, the last tag"),
    ],
)
def test_what_stands_against_a_release_is_said(checkout, version, before, said):
    git(checkout, "tag", "v0.1.0")
    if before:
        (checkout / before).write_text("changed")
    with pytest.raises(release().RefusedError, match=re.escape(said)):
        release().texts(checkout, version, datetime.date(2030, 1, 2))


def test_all_places_have_one_version():
    for name, pattern in release().PLACES.items():
        ((_, version, _),) = re.findall(pattern, (ROOT / name).read_text(encoding="utf-8"))
        assert version == PROJECT["version"], name


def test_the_recipe_of_conda_wants_what_the_project_wants():
    """By line, as tests have no reader of YAML."""
    text = (SCRIPTS / "recipe.yaml").read_text(encoding="utf-8")
    lines = text[text.index("  run:\n") : text.index("tests:")].splitlines()[1:]
    found = dict(re.fullmatch(r"    - (\S+) ?(.*)", line).groups() for line in lines if line)
    extras = PROJECT["optional-dependencies"]
    wanted = [*PROJECT["dependencies"], *extras["pictures"]]
    for requirement in map(Requirement, wanted):
        name = CONDA.get(requirement.name, requirement.name)
        assert set(found.pop(name).split(",")) == set(str(requirement.specifier).split(",")), name
    assert set(found) == BESIDES
    assert f">={PROJECT['requires-python'].removeprefix('>=')}" == found["python"]


def test_the_image_of_apptainer_has_the_packages_of_the_dockerfile():
    packages = [
        re.search(r"--no-install-recommends \\\n(.*?openmpi-bin)", path.read_text(), re.DOTALL)[1]
        for path in (ROOT / "Dockerfile", SCRIPTS / "fenics-contact.def")
    ]
    first, second = (set(text.replace("\\", " ").split()) for text in packages)
    assert first == second


def test_workflows_run_what_there_is():
    targets = (ROOT / "Makefile").read_text(encoding="utf-8")
    files = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
    assert len(files) == 2
    for path in files:
        text = path.read_text(encoding="utf-8")
        for target in re.findall(r"\bmake (\w+)", text):
            assert f"\n{target}: ##" in targets
        for program in re.findall(r"\s(\.\S+/run)\b", text):
            assert (ROOT / program).is_file()


def test_pages_of_versions_stand_side_by_side(checkout, tmp_path):
    """And are pushed; those of one version are replaced, those of another one kept."""
    origin = tmp_path / "origin.git"
    git(tmp_path, "init", "--quiet", "--bare", str(origin))
    git(checkout, "remote", "add", "origin", str(origin))
    pages = tmp_path / "html"
    publish = script("publish")
    for version, name in (("v0.2.0", "a.html"), ("latest", "b.html"), ("latest", "c.html")):
        if pages.exists():
            for old in pages.iterdir():
                old.unlink()
        pages.mkdir(exist_ok=True)
        (pages / "index.html").write_text(version)
        (pages / name).write_text(name)
        publish.publish(checkout, pages, version, push=True)
    names = git(origin, "ls-tree", "-r", "--name-only", "gh-pages").split()
    kept = ["v0.2.0/a.html", "v0.2.0/index.html"]
    assert names == [".nojekyll", "index.html", "latest/c.html", "latest/index.html", *kept]
    front = git(origin, "show", "gh-pages:index.html")
    assert "url=latest/" in front and 'href="v0.2.0/"' in front
    assert git(checkout, "branch", "--show-current").strip() == "main"
    assert git(checkout, "status", "--porcelain") == ""


def test_publishing_nothing_is_refused(tmp_path):
    for arguments, said in (
        (["latest", "--pages", str(tmp_path)], "has no pages; make docs builds them"),
        (["../x"], "neither a version nor latest"),
    ):
        command = [sys.executable, str(SCRIPTS / "publish.py"), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 2 and said in done.stderr and "Traceback" not in done.stderr
        assert not Path(tmp_path, "index.html").exists()
