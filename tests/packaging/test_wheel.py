"""The wheel: one file for every CPython from 3.11 on, and for every glibc from 2.28 on."""

import shutil
import subprocess
import sys
import zipfile

import elf
import products
import pytest

OLDEST_GLIBC = (2, 28)
SYSTEM_LIBRARIES = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "ld-linux-x86-64.so.2"}
SYSTEM_LIBRARIES |= {"libgcc_s.so.1", "libutil.so.1"}


def native_library():
    with zipfile.ZipFile(products.WHEEL) as wheel:
        names = [name for name in wheel.namelist() if name.endswith(".so")]
        assert len(names) == 1, names
        assert names[0].endswith(".abi3.so")
        return wheel.read(names[0])


def glibc(versions):
    numbers = [name.removeprefix("GLIBC_") for names in versions.values() for name in names if name[:7] == "GLIBC_2"]
    return max(tuple(int(part) for part in number.split(".")) for number in numbers)


def test_wheel_says_abi3_and_manylinux():
    with zipfile.ZipFile(products.WHEEL) as wheel:
        text = wheel.read(f"thenar-{products.VERSION}.dist-info/WHEEL").decode()
    assert "Tag: cp311-abi3-manylinux_2_28_x86_64" in text


def test_library_needs_no_newer_glibc_than_it_says():
    _, versions = elf.needed(native_library())
    assert glibc(versions) <= OLDEST_GLIBC, versions


def test_library_needs_nothing_but_the_system():
    libraries, _ = elf.needed(native_library())
    assert set(libraries) <= SYSTEM_LIBRARIES


@pytest.mark.skipif(not shutil.which("objdump"), reason="objdump is not installed")
def test_elf_reader_agrees_with_objdump():
    with open(sys.executable, "rb") as file:
        libraries, versions = elf.needed(file.read())
    told = subprocess.run(["objdump", "-p", sys.executable], capture_output=True, text=True, check=True).stdout
    assert libraries == [line.split()[1] for line in told.splitlines() if line.strip().startswith("NEEDED")]
    references = told.split("Version References:")[1]
    assert {name for names in versions.values() for name in names} == {
        line.split()[-1] for line in references.splitlines() if line.strip().startswith("0x")
    }


@pytest.mark.parametrize("environment", ["venv", "venv45", "venv313"])
def test_module_imports_and_knows_its_version(environment):
    if environment == "venv313" and not (products.TARGET / environment).exists():
        pytest.skip("no CPython 3.13 on this machine")
    end = products.run(environment, ["-c", "import thenar; print(thenar.__version__)"])
    assert end.stdout.strip() == products.VERSION, end.stderr
