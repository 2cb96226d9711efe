"""Where Spot's wheel does not fit: rulec does without, or with a Spot from conda-forge."""

import pytest

FOREIGN = {
    "macOS arm64": {"system": "Darwin", "machine": "arm64", "libc": None},
    "Linux aarch64 with glibc 2.36": {"machine": "aarch64"},
    "Linux x86_64 with glibc 2.33": {"libc": "glibc 2.33"},
    "Linux x86_64 without glibc": {"libc": None},
    "Linux x86_64 (32-bit Python) with glibc 2.36": {"maxsize": 2**31 - 1},
}


@pytest.mark.parametrize("place", FOREIGN)
def test_platform_without_wheel_does_without_spot(checkout, place):
    checkout.add_tool("python3", **FOREIGN[place])
    result = checkout.call()
    assert result.returncode == 0
    assert f"this is {place}. rulec compiles without it" in result.stderr
    assert "--system-site-packages" not in checkout.calls("venv")[0]["arguments"]
    needed = checkout.calls("pip")[0]["requirements"]
    assert "spottl" not in needed
    assert "\nlark==" in needed


def test_windows_is_refused(checkout):
    checkout.add_tool("python3", system="Windows", machine="AMD64", libc=None)
    result = checkout.call()
    assert result.returncode == 2
    assert result.stderr == "rulec: rulec runs on Linux and macOS, and this is Windows AMD64.\n"
    assert checkout.calls() == []
    assert not checkout.environment.exists()


@pytest.mark.parametrize("libc", ["glibc 2.34", "glibc 2.100", "glibc 3.0"])
def test_glibc_from_2_34_will_do(checkout, libc):
    checkout.add_tool("python3", libc=libc)
    assert checkout.call().returncode == 0
    assert "--system-site-packages" not in checkout.calls("venv")[0]["arguments"]


@pytest.mark.parametrize("tool", ["venv", "uv venv"])
def test_own_spot_stands_for_the_wheel(checkout, tool):
    checkout.add_tool("python3", **FOREIGN["macOS arm64"], spot="2.14.1")
    if tool == "uv venv":
        checkout.add_tool("uv")
    assert checkout.call().returncode == 0
    assert "--system-site-packages" in checkout.calls(tool)[0]["arguments"]
    stand_in = checkout.environment / "site" / "spottl-2.14.1.dist-info" / "METADATA"
    assert "Name: spottl\nVersion: 2.14.1\n" in stand_in.read_text()
    needed = checkout.calls(tool.replace("venv", "pip").strip())[0]["requirements"]
    assert "spottl" not in needed
    assert "\nshapely==" in needed


def test_own_spot_is_taken_where_the_wheel_would_fit_if_asked_for(checkout):
    checkout.add_tool("python3", spot="2.14.1")
    assert checkout.call(RULEC_OWN_SPOT="1").returncode == 0
    assert (checkout.environment / "site" / "spottl-2.14.1.dist-info").is_dir()
    assert "spottl" not in checkout.calls("pip")[0]["requirements"]


def test_own_spot_that_is_not_there_is_refused_with_the_way_out(checkout):
    result = checkout.call(RULEC_OWN_SPOT="1")
    assert result.returncode == 2
    assert "has none. Set RULEC_PYTHON to the Python into which it was installed." in result.stderr
    assert checkout.calls() == []


def test_own_spot_stays_with_the_environment(checkout):
    looks = FOREIGN["macOS arm64"]
    checkout.add_tool("python3", **looks)
    conda = checkout.add_tool("conda", **looks, spot="2.14.1")
    assert checkout.call(RULEC_PYTHON=str(conda)).returncode == 0
    (checkout.folder / "pyproject.toml").write_text("# pulled\n")
    assert checkout.call().returncode == 0  # not asked for again, and python3 would not do
