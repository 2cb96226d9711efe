# shellcheck shell=sh disable=SC2034,SC2154 # the launcher's files share their variables
# Chooses the Python for the environment. Sourced by set_up.sh.

# Prints four lines: the version ("3.12", with another word if it is not plain CPython), whether it
# can create environments, the platform ("wheel" if Spot's wheel fits), and the interpreter's path
# without symlinks, so that a system upgrade that replaces it breaks the environment visibly.
# Every Python must be able to run this, so that a version that is too old is reported as such.
probe='
import os, platform, sys, sysconfig
version = "%d.%d" % sys.version_info[:2]
if platform.python_implementation() != "CPython":
    version += " " + platform.python_implementation()
elif sysconfig.get_config_var("Py_GIL_DISABLED"):
    version += " free-threaded"
try:
    import ensurepip, venv
    venv = "venv"
except ImportError:
    venv = "no venv"
try:
    libc = os.confstr("CS_GNU_LIBC_VERSION").split()[1]
except (AttributeError, IndexError, OSError, ValueError):
    libc = ""
system, machine = platform.system(), platform.machine()
if sys.maxsize < 2**32:
    machine += " (32-bit Python)"
place = "%s %s" % ({"Darwin": "macOS"}.get(system, system), machine)
if system == "Linux":
    place += " with glibc " + libc if libc else " without glibc"
    if machine == "x86_64" and libc and [int(n) for n in libc.split(".")[:2]] >= [2, 34]:
        place = "wheel" if sys.version_info < (3, 14) else place + " and Python " + version
sys.stdout.write("\n".join((version, venv, place, os.path.realpath(sys.executable))))
'

# Sets status to that of starting a Python, which is killed if it takes 20 s.
try_to_start() {
    "$1" -E -c '' >/dev/null 2>&1 </dev/null &
    candidates_process=$!
    (
        trap 'kill "$nap"' TERM
        sleep 20 &
        nap=$!
        wait "$nap" && kill -s KILL "$candidates_process"
    ) >/dev/null 2>&1 </dev/null &
    guard=$!
    await "$candidates_process"
    kill "$guard" 2>/dev/null
}

# Sets python, version and place to those of the first suitable Python.
find_python() {
    if [ -n "${RULEC_PYTHON:-}" ]; then
        set -- "$RULEC_PYTHON"
    else
        set -- python3 python3.13 python3.12 python3.11 python3.10 python3.14 python
    fi
    seen=
    for candidate in "$@"; do
        if ! command -v "$candidate" >/dev/null 2>&1; then
            [ -z "${RULEC_PYTHON:-}" ] || seen=", $candidate is not found"
            [ ! -e "$candidate" ] || seen=", $candidate does not run"
            continue
        fi
        answer='' fault='does not run'
        try_to_start "$candidate"
        if [ "$status" -gt 128 ]; then fault='does not answer'; fi
        if [ "$status" = 0 ]; then
            answer=$("$candidate" -E -c "$probe" 2>/dev/null </dev/null) || answer=
        fi
        {
            IFS= read -r version
            IFS= read -r venv
            IFS= read -r place
            IFS= read -r python
        } <<EOF
$answer
EOF
        case $version in
        3.10 | 3.11 | 3.12 | 3.13 | 3.14)
            if [ "$venv" = venv ] || [ -n "$uv" ]; then return; fi
            seen="$seen, $candidate ($version) lacks venv and ensurepip (on Debian and Ubuntu: \
apt install python$version-venv)"
            ;;
        '') seen="$seen, $candidate $fault" ;;
        *) seen="$seen, $candidate is $version" ;;
        esac
    done
    seen=${seen#, }
    stop "a Python from 3.10 to 3.14 with venv is needed; ${seen:-there is none on PATH}." \
        "Install one${uv:+ (uv python install 3.13)}, or set RULEC_PYTHON to one, and call again."
}

# If no wheel fits or none is wanted, sets leave_wheel, and own_spot to the version of the Spot that
# python itself has, if any: rulec then compiles with that Spot, or without Spot.
check_platform() {
    own_spot= leave_wheel=
    if [ "$place" = wheel ] && [ -z "${RULEC_OWN_SPOT:-}" ]; then return; fi
    case $place in Windows*) stop "rulec runs on Linux and macOS, and this is $place." ;; esac
    leave_wheel=yes
    own_spot=$("$python" -E -c 'import spot; print(spot.version())' 2>/dev/null </dev/null) && return
    [ "$place" != wheel ] ||
        stop "RULEC_OWN_SPOT asks for a Spot of your own, but $python has none. Set RULEC_PYTHON to" \
            "the Python into which it was installed."
    own_spot=
    say "Spot comes ready-made only for Linux on x86-64 with glibc 2.34 or newer and Python up to" \
        "3.13, and this is $place. rulec compiles without it; to use your own Spot see docs/installation.md."
}
