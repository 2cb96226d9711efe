# shellcheck shell=sh disable=SC2034,SC2154 # the launcher's files share their variables
# Runs uv and pip: their settings, their output, and its meaning. Sourced by set_up.sh.

# Keeps pip's settings for the index and certificates, and applies them to uv, too; unsets those that
# would install the packages elsewhere.
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

# Runs a command in the checkout with its output in the log. It runs in the background, because a
# shell delays signals until a foreground command ends, and in its own process group, so that it can
# be killed as a whole. Its temporary files are removed with the environment.
quietly() {
    mkdir -p "$stamps/tmp" 2>/dev/null
    TMPDIR=$stamps/tmp "$python" -E -c "$in_own_group" "$home" "$@" >"$log" 2>&1 </dev/null &
    await "$!"
}

# Renamed first, so that even if killed here, no partial environment stays in place.
discard() {
    if [ -e "$environment" ]; then mv "$environment" "$environment.gone"; fi
    rm -rf "$environment.gone"
}

log_has() { grep -qiE "$1" "$log"; }

# If the index is unreachable or untrusted, an installer stops before it changes anything.
is_untrusted() { log_has 'certificate'; }
is_unreachable() {
    log_has 'name resolution|failed to resolve|dns error|unreachable|newconnection|proxyerror' ||
        log_has 'connection (refused|reset|broken)|timed out|error sending request'
}

# Stops with the reason found in the installer's output, or else with the end of that output.
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
installed. Ask the operator of your package index before you call again."
    elif log_has 'no matching distribution|could not find a version|no solution found'; then
        tail -n 20 "$log" | sed 's/^/  | /' >&2
        reason="the package index lacks a release that the lock names. Use another index \
(PIP_INDEX_URL), or use the releases that it has, unchecked, with RULEC_UNLOCKED=1, and call again."
    elif log_has 'no space left|disk quota' || [ ! -s "$log" ]; then # the log had no room either
        reason="the disk is full, it seems; the environment takes up to 500 MB. Make room, and \
call again."
    else
        tail -n 20 "$log" | sed 's/^/  | /' >&2
        reason="the installation failed with the output above. Fix the problem, and call again."
    fi
    if [ -n "$keep" ] && [ -d "$stamps/before" ]; then
        mv "$stamps/before/"* "$stamps"
        rm -rf "$stamps/before" "$stamps/tmp" "$log"
    else
        discard
    fi
    stop "$reason"
}
