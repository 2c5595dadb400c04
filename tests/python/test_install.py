"""An installed package, and one from a wheel, are imported without the build tree."""

import base64
import hashlib
import importlib.util
import os
import pathlib
import shutil
import stat
import subprocess
import sys
import zipfile

import hmax
import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
QUESTION = 'import hmax; print(hmax.__file__, hmax.largest_stable_step("rk4", [[100.0]], [0.01]).bound)'


@pytest.fixture(scope="module")
def build():
    folder = os.environ.get("HMAX_BUILD_DIR")
    if not folder:
        pytest.skip("HMAX_BUILD_DIR does not name the build")
    return folder


def imported_from(folder):
    """What a fresh interpreter says with this folder alone on its path."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    told = subprocess.run([sys.executable, "-c", QUESTION], check=True, capture_output=True, text=True, env=environment, cwd=folder)
    return told.stdout.split()


def test_the_installed_package_is_imported(build, tmp_path):
    subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", tmp_path], check=True, stdout=subprocess.DEVNULL)
    package = next(tmp_path.rglob("hmax/__init__.py"))
    assert (package.parent / "py.typed").exists() and not package.is_symlink()
    assert imported_from(package.parent.parent) == [str(package), "stability"]


def test_the_module_offers_its_functions_to_nobody():
    # A sin or exp of its own that others could see would take the place of theirs, and theirs of its own.
    if not shutil.which("nm"):
        pytest.skip("nm is not installed")
    told = subprocess.run(["nm", "-D", "--defined-only", "-P", hmax._core.__file__], check=True, capture_output=True, text=True)
    names = {line.split()[0] for line in told.stdout.splitlines()}
    assert {name for name in names if not name.startswith("_Z")} == {"PyInit__core"}


@pytest.fixture(scope="module")
def wheel(build, tmp_path_factory):
    made = subprocess.run(
        [sys.executable, SOURCE / "scripts/wheel", "--build", build, "--output", tmp_path_factory.mktemp("dist")],
        check=True,
        capture_output=True,
        text=True,
    )
    return pathlib.Path(made.stdout.strip())


def test_the_record_of_a_wheel_has_the_digest_of_each_file(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (record,) = [name for name in archive.namelist() if name.endswith("RECORD")]
        rows = [line.split(",") for line in archive.read(record).decode().splitlines()]
        assert sorted(name for name, _, _ in rows) == sorted(archive.namelist())
        for name, digest, size in rows:
            if name == record:
                continue
            content = archive.read(name)
            expected = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            assert (digest, size) == ("sha256=" + expected, str(len(content)))


def test_a_wheel_is_installed_and_imported(wheel, tmp_path):
    if importlib.util.find_spec("pip"):
        subprocess.run(
            [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", tmp_path, wheel], check=True
        )
    else:
        zipfile.ZipFile(wheel).extractall(tmp_path)
    assert imported_from(tmp_path) == [str(tmp_path / "hmax" / "__init__.py"), "stability"]


def test_a_wheel_alone_needs_the_c_library_only(build, tmp_path):
    if not shutil.which("patchelf"):
        pytest.skip("patchelf is not installed")
    made = subprocess.run(
        [sys.executable, SOURCE / "scripts/wheel", "--build", build, "--output", tmp_path, "--alone"], check=True, capture_output=True, text=True
    )
    package = tmp_path / "package"
    with zipfile.ZipFile(made.stdout.strip()) as archive:
        archive.extractall(package)
        program = package / "hmax_program/bin/hmax"
        assert archive.getinfo("hmax_program/bin/hmax").external_attr >> 16 == stat.S_IFREG | 0o755
    program.chmod(0o755)
    for binary in [program, *package.rglob("*.so"), *package.glob("hmax.libs/*")]:
        told = subprocess.run(["ldd", binary], check=True, capture_output=True, text=True).stdout
        outside = {line.split()[0].split(".so")[0] for line in told.splitlines() if "=>" in line and str(package) not in line}
        assert outside <= {"libc", "libm", "libdl", "librt", "libpthread"}, told
    run = subprocess.run(
        [sys.executable, "-c", "import hmax_program; hmax_program.main()", "doctor"], check=True, capture_output=True, text=True, cwd=package
    )
    assert "fingerprint" in run.stdout or "kernels" in run.stdout
    assert imported_from(package) == [str(package / "hmax" / "__init__.py"), "stability"]
