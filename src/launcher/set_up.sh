# shellcheck shell=sh disable=SC2034,SC2154 # the launcher's files share their variables
# Makes the launcher's environment, or renews it. Sourced by the launcher.

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
    [ -w "$home" ] || stop "cannot write to $home, where its environment .venv has to go." \
        "Copy the checkout to a folder of your own and call it there."
    rm -rf "$environment.gone"
    if [ -d "$environment" ]; then rmdir "$environment" 2>/dev/null; fi
    if [ -L "$environment" ] || { [ -e "$environment" ] && [ ! -d "$stamps" ]; }; then
        stop "$environment is there already, not made by rulec, which needs the place for its own" \
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

# The kernel's lock on the checkout's folder ends with its last holder, killed or not, including an
# installer that has outlived the launcher: it cannot go stale, and leaves no file behind.
lock='
import fcntl, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
try:
    fcntl.flock(9, fcntl.LOCK_EX | fcntl.LOCK_NB)
except BlockingIOError:
    sys.stderr.write("rulec: another call is at the set-up; waiting for its end ...\n")
    fcntl.flock(9, fcntl.LOCK_EX)
except OSError:
    pass  # a file system without locks
'

interrupted() {
    trap '' HUP INT TERM
    if [ -n "$child" ]; then
        kill -s INT -- "-$child" 2>/dev/null || kill -s TERM "$child" 2>/dev/null
        wait "$child"
    fi
    discard
    say "interrupted; the unfinished environment is removed."
    exit "$1"
}

# Lets a Spot from elsewhere stand for the wheel: a distribution of the wheel's name, and empty.
bring_own_spot() {
    [ -n "$own_spot" ] || return 0
    site=$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
    mkdir -p "$site/spottl-$own_spot.dist-info"
    printf 'Metadata-Version: 2.1\nName: spottl\nVersion: %s\n' "$own_spot" \
        >"$site/spottl-$own_spot.dist-info/METADATA"
}

# Every release is one of the lock's, and every file has one of its hashes, the tools that build rulec
# included; then the project itself, editable, without looking for anything. RULEC_UNLOCKED takes
# today's releases within the ranges of pyproject.toml instead.
install_project() {
    if [ -n "${RULEC_UNLOCKED:-}" ]; then
        install_with -e ".$extra"
        return
    fi
    kept=$stamps/requirements.txt
    awk -v leave="$leave_wheel" '/^[^ #]/ { left_out = leave != "" && /^spottl==/ } !left_out' \
        "$home/src/launcher/locks/python$version${extra:+-test}.txt" >"$kept" || return
    install_with --require-hashes -r "$kept" && install_with --no-deps --no-build-isolation -e . &&
        rm -f "$kept"
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

# uv reads neither pip's configuration nor the system's certificates: where it fails, pip may do.
leave_uv() {
    [ -n "$uv" ] || return 1
    say "uv could not; trying venv and pip ..."
    uv=
}

# Why an environment that is there will not do.
say_why_anew() {
    if [ ! -r "$stamps/run" ]; then
        say "the last set-up did not finish; starting over ..."
    elif [ -n "$made_from" ] && [ "${made_from#* * }" != "$home" ]; then
        say "the environment here was made for ${made_from#* * }; making a new one ..."
    else
        say "the environment's Python is gone, or another one is asked for; making a new one ..."
    fi
}

make_anew() {
    if [ -d "$environment" ]; then say_why_anew; fi
    check_space
    build || { leave_uv && build; }
}

# The environment stays; without its stamps it counts as unfinished for as long as this takes.
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
    child=
    trap 'interrupted 129' HUP
    trap 'interrupted 130' INT
    trap 'interrupted 143' TERM
    extra=
    if [ "$purpose" = test ]; then extra='[test]'; fi
    if read_stamp run && [ "${made_from#* * }" = "$home" ]; then
        add_to_it || give_up
    else
        make_anew || give_up
    fi
    write_stamps || give_up
    rm -rf "$stamps/before" "$stamps/tmp" "$log"
    trap - HUP INT TERM
    say "ready."
}

set_up() {
    # An environment keeps to the Python that it was once asked to be made with.
    read_stamp run
    if [ -n "$made_with" ] && command -v "$made_with" >/dev/null; then
        RULEC_PYTHON=${RULEC_PYTHON:-$made_with}
    fi
    asked=${RULEC_PYTHON:-}
    export PATH="${PATH:-/usr/local/bin:/usr/bin:/bin}" # without one, Python does not find itself
    settle_installers
    find_python
    check_platform
    exec 9<"$home"
    "$python" -E -c "$lock"
    is_ready || make_ready
    exec 9<&-
}
