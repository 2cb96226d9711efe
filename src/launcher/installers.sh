# shellcheck shell=sh disable=SC2034,SC2154 # the launcher's files share their variables
# Running uv and pip: their settings, their words, and what these mean. Sourced by set_up.sh.

# pip's settings that choose an index or certificates stay, and hold for uv too; those that would
# send the packages elsewhere go.
settle_installers() {
    unset VIRTUAL_ENV UV_PYTHON UV_SYSTEM_PYTHON PIP_PYTHON PIP_TARGET PIP_PREFIX PIP_ROOT \
        PIP_REQUIRE_VIRTUALENV PIP_REQUIREMENT PIP_EDITABLE PIP_NO_DEPS PIP_DRY_RUN PIP_REPORT
    [ -n "${RULEC_UNLOCKED:-}" ] || unset PIP_CONSTRAINT UV_CONSTRAINT # the lock chooses
    export PIP_USER=0 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_RETRIES="${PIP_RETRIES:-2}"
    [ -z "${PIP_INDEX_URL:-}" ] || export UV_DEFAULT_INDEX="${UV_DEFAULT_INDEX:-$PIP_INDEX_URL}"
    [ -z "${PIP_EXTRA_INDEX_URL:-}" ] || export UV_INDEX="${UV_INDEX:-$PIP_EXTRA_INDEX_URL}"
    [ -z "${PIP_CERT:-}" ] || export SSL_CERT_FILE="${SSL_CERT_FILE:-$PIP_CERT}"
    uv=
    if [ -z "${PIP_NO_INDEX:-}" ]; then uv=$(command -v uv); fi
}

in_own_group='
import os, signal, sys
os.setpgid(0, 0)
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.chdir(sys.argv[1])
os.execvp(sys.argv[2], sys.argv[2:])
'

# Runs a command in the checkout, its words going to the log. In the background, because a shell
# puts off a signal until a command in front ends; in a group of its own, to be ended whole. What
# it leaves in its temporary folder when it is ended goes with the environment.
quietly() {
    mkdir -p "$stamps/tmp" 2>/dev/null
    TMPDIR=$stamps/tmp "$python" -E -c "$in_own_group" "$home" "$@" >"$log" 2>&1 </dev/null &
    child=$!
    wait "$child"
    status=$?
    child=
    return "$status"
}

# Renamed first, so that not even a kill leaves half of it in place.
discard() {
    if [ -e "$environment" ]; then mv "$environment" "$environment.gone"; fi
    rm -rf "$environment.gone"
}

log_has() { grep -qiE "$1" "$log"; }

# Without the index, or its trust, an installer stops before it has changed anything.
is_untrusted() { log_has 'certificate'; }
is_unreachable() {
    log_has 'name resolution|failed to resolve|dns error|unreachable|newconnection|proxyerror' ||
        log_has 'connection (refused|reset|broken)|timed out|error sending request'
}

# Stops with the reason found in the installer's words, or else with the last of these.
give_up() {
    keep=
    if is_untrusted; then
        keep=yes
        reason="the package index shows a certificate that is not trusted here. Set SSL_CERT_FILE \
to the certificates of your network, and call again."
    elif is_unreachable; then
        keep=yes
        reason="the package index cannot be reached. Check the network (behind a proxy or with a \
mirror: HTTPS_PROXY, PIP_INDEX_URL), and call again."
    elif log_has 'do not match the hashes|hash mismatch'; then
        tail -n 20 "$log" | sed 's/^/  | /' >&2
        reason="a package is not the one that the lock names: its hash differs, so nothing of it was \
installed. Ask whoever runs your package index before you call again."
    elif log_has 'no matching distribution|could not find a version|no solution found'; then
        tail -n 20 "$log" | sed 's/^/  | /' >&2
        reason="the package index lacks a release that the lock names. Use another index \
(PIP_INDEX_URL), or take the releases that it has, unchecked, with RULEC_UNLOCKED=1, and call again."
    elif log_has 'no space left|disk quota' || [ ! -s "$log" ]; then # the log had no room either
        reason="the disk is full, it seems; the environment takes up to 500 MB. Make room, and \
call again."
    else
        tail -n 20 "$log" | sed 's/^/  | /' >&2
        reason="the installation failed with the words above. See what is amiss, and call again."
    fi
    if [ -n "$keep" ] && [ -d "$stamps/before" ]; then
        mv "$stamps/before/"* "$stamps"
        rm -rf "$stamps/before" "$stamps/tmp" "$log"
    else
        discard
    fi
    stop "$reason"
}
