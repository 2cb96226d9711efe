# shellcheck shell=sh disable=SC2034,SC2154 # the launcher's files share their variables
# Creates or updates the launcher's environment. Sourced by the launcher.

for part in python installers; do
    # shellcheck source=/dev/null
    . "$home/src/launcher/$part.sh"
done

say() { printf 'rulec: %s\n' "$*" >&2; }

stop() {
    say "$*"
    exit 2
}

check_folder() {
    if [ ! -w "$home" ]; then
        unreachable=
        if [ -L "$environment/bin/python" ] && [ ! -x "$environment/bin/python" ]; then
            unreachable="cannot reach the Python of its environment $environment, and for another one "
        fi
        stop "${unreachable}cannot write to $home, where its environment .venv has to go." \
            "Copy the checkout to a folder of your own and call it there."
    fi
    rm -rf "$environment.gone"
    if [ -d "$environment" ]; then rmdir "$environment" 2>/dev/null; fi
    if [ -L "$environment" ] || { [ -e "$environment" ] && [ ! -d "$stamps" ]; }; then
        stop "$environment exists but was not made by rulec, which needs that path for its own" \
            "environment. Move it away or delete it, and call again."
    fi
}

check_space() {
    case $purpose in test) megabytes=1000 ;; *) megabytes=500 ;; esac
    free=$(df -Pk "$home" 2>/dev/null | awk 'NR == 2 { print $4 }')
    case $free in
    '' | *[!0-9]*) ;;
    *)
        [ "$free" -ge $((megabytes * 1024)) ] ||
            stop "rulec's environment takes up to $megabytes MB, but the disk of" \
            "$home has only $((free / 1024)) MB left. Make room and call again."
        ;;
    esac
}

# Waits for a background command, which ignores SIGINT, so that a signal is answered by the launcher
# alone, and at once.
await() {
    child=$1
    wait "$child" 2>/dev/null
    status=$?
    child=
    return "$status"
}

# The kernel releases the lock on the checkout's folder when its last holder ends, even if killed,
# including an installer that outlives the launcher: it cannot go stale, and leaves no file behind.
lock='
import fcntl, sys
try:
    fcntl.flock(9, fcntl.LOCK_EX | fcntl.LOCK_NB)
except BlockingIOError:
    sys.stderr.write("rulec: another call is setting up; waiting for it to finish ...\n")
    sys.stderr.flush()
    fcntl.flock(9, fcntl.LOCK_EX)
except OSError:
    pass  # a file system without locks
'

interrupted() {
    trap '' HUP INT TERM
    if [ -n "$child" ]; then
        kill -s INT -- "-$child" 2>/dev/null || kill -s TERM "$child" 2>/dev/null
        wait "$child" 2>/dev/null
    fi
    if [ -n "$making" ]; then
        discard
        say "interrupted; the unfinished environment is removed."
    else
        say "interrupted."
    fi
    exit "$1"
}

# Lets another Spot stand in for the wheel: an empty distribution with the wheel's name.
bring_own_spot() {
    [ -n "$own_spot" ] || return 0
    site=$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))' \
        2>>"$log") || return
    mkdir -p "$site/spottl-$own_spot.dist-info"
    printf 'Metadata-Version: 2.1\nName: spottl\nVersion: %s\n' "$own_spot" \
        >"$site/spottl-$own_spot.dist-info/METADATA"
}

# Installs the lock's releases, checked by their hashes, including rulec's build tools; then the
# project itself, editable, without resolving anything. With RULEC_UNLOCKED it installs current
# releases within the ranges of pyproject.toml instead.
install_project() {
    if [ -n "${RULEC_UNLOCKED:-}" ]; then
        install_with -e ".$extra"
        return
    fi
    kept=$stamps/requirements.txt
    awk -v leave="$leave_wheel" '/^[^ #]/ { left_out = leave != "" && /^spottl==/ } !left_out' \
        "$home/src/launcher/locks/python$version${extra:+-test}.txt" >"$kept" || return
    install_with --only-binary :all: --require-hashes -r "$kept" &&
        install_with --no-deps --no-build-isolation -e . &&
        rm -f "$kept"
}

# Names the checkout from site-packages, not from the root: Python 3.11 reads these files in the
# locale's encoding, and with LC_ALL=C does not start where a folder's name is not ASCII.
link_checkout() {
    for link in "$environment"/lib/python*/site-packages/*_rulec.pth; do
        [ -f "$link" ] || continue
        { echo ../../../../src >"$link.new" && mv "$link.new" "$link"; } || return
    done
}

install_with() {
    if [ -n "$uv" ]; then
        quietly "$uv" pip install --quiet --python "$environment/bin/python" "$@"
    else
        quietly "$environment/bin/python" -m pip install --quiet --no-input "$@"
    fi
}

build() {
    discard
    mkdir "$environment" "$stamps" || stop "cannot write to $home; call it in a folder of your own."
    set -- ${own_spot:+--system-site-packages}
    if [ -n "$uv" ]; then
        say "making a private environment in $environment (Python $version, uv) ..."
        quietly "$uv" venv --quiet --seed --allow-existing --python "$python" "$@" .venv || return
    else
        say "making a private environment in $environment (Python $version, venv and pip) ..."
        quietly "$python" -m venv "$@" .venv || return
    fi
    bring_own_spot || return
    say "installing rulec and what it needs ..."
    install_project
}

# uv reads neither pip's configuration nor the system's certificates: if it fails, pip may succeed.
leave_uv() {
    [ -n "$uv" ] || return 1
    say "uv failed; trying venv and pip ..."
    uv=
}

# Why the existing environment cannot be used.
say_why_anew() {
    if [ ! -r "$stamps/run" ]; then
        say "the last set-up did not finish; starting over ..."
    elif [ -n "$made_from" ] && [ "${made_from#* * }" != "$home" ]; then
        say "the environment here was made for ${made_from#* * }; making a new one ..."
    else
        say "the environment's Python is gone, or another one is requested; making a new one ..."
    fi
}

make_anew() {
    if [ -d "$environment" ]; then say_why_anew; fi
    check_space
    build || { leave_uv && build; }
}

# The environment stays; without its stamps it counts as unfinished during the installation.
add_to_it() {
    if [ "$made_from" = "$wanted" ]; then
        say "adding what the tests need ..."
    else
        say "pyproject.toml has changed; installing again ..."
    fi
    mkdir "$stamps/before" && mv "$stamps/run" "$stamps/before"
    if [ -f "$stamps/test" ]; then mv "$stamps/test" "$stamps/before"; fi
    install_project && return
    leave_uv || return
    if is_untrusted || is_unreachable; then install_project; else build; fi
}

write_stamps() {
    if [ "$purpose" = test ]; then printf '%s\n' "$wanted" "$asked" >"$stamps/test" || return; fi
    printf '%s\n' "$wanted" "$asked" >"$stamps/run"
}

make_ready() {
    check_folder
    log=$stamps/log
    making=yes
    extra=
    if [ "$purpose" = test ]; then extra='[test]'; fi
    if read_stamp run && [ "${made_from#* * }" = "$home" ]; then
        add_to_it || give_up
    else
        make_anew || give_up
    fi
    { link_checkout && write_stamps; } || give_up
    rm -rf "$stamps/before" "$stamps/tmp" "$log"
    say "ready."
}

set_up() {
    child='' making=''
    trap 'interrupted 129' HUP
    trap 'interrupted 130' INT
    trap 'interrupted 143' TERM
    # An environment keeps the Python that was requested when it was made.
    read_stamp run
    if [ -n "$made_with" ] && command -v "$made_with" >/dev/null; then
        RULEC_PYTHON=${RULEC_PYTHON:-$made_with}
    fi
    asked=${RULEC_PYTHON:-}
    export PATH="${PATH:-/usr/local/bin:/usr/bin:/bin}" # without one, Python does not find itself
    settle_installers
    find_python
    check_settings "$python"
    check_platform
    exec 9<"$home"
    "$python" -E -c "$lock" &
    await "$!" || stop "the Python in $python does not run. Set RULEC_PYTHON to another one, and" \
        "call again."
    is_ready || make_ready
    trap - HUP INT TERM
    exec 9<&-
}
