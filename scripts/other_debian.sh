#!/usr/bin/env bash
# Makes a Debian of another version in a folder, and runs a command in it on a copy of this checkout.  As root:
#
#     scripts/other_debian.sh FOLDER                         # makes it: trixie (13) on Debian 12, else bookworm (12)
#     scripts/other_debian.sh FOLDER bash tests/run.sh       # the tests there
#     scripts/other_debian.sh FOLDER ./run_all.sh quick
#     SUITE=bookworm scripts/other_debian.sh FOLDER ...      # another version, when it is made
#
# What git does not ignore is copied to FOLDER/work anew each time; what the command writes stays there.  The scripts
# that it calls install Debian's packages by themselves.  Mounts vanish with the command.  About 4 GB with YADE.
# MIRROR: of Debian's packages (without: the one that debootstrap takes).
#
# The exit status is the command's; 3 where debootstrap is missing or fails.
set -euo pipefail

say() { printf '%s\n' "$*" >&2; }

[ $# -gt 0 ] || { say "error: no folder: expected one, like scripts/other_debian.sh /var/tmp/trixie"; exit 2; }
[ "$EUID" -eq 0 ] || { say "error: debootstrap and chroot need root; run this script as root"; exit 3; }
folder=$1
shift
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [ -z "${SUITE:-}" ]; then
    SUITE=bookworm
    ! grep -qs '^VERSION_CODENAME=bookworm' /etc/os-release || SUITE=trixie
fi

if [ ! -e "$folder/etc/debian_version" ]; then
    [ -n "$(type -P debootstrap)" ] || { say "error: no debootstrap: get it with: apt-get install debootstrap"; exit 3; }
    mkdir -p "$folder"
    debootstrap --variant=minbase --include=git,ca-certificates "$SUITE" "$folder" ${MIRROR:+"$MIRROR"} >&2 || exit 3
fi
say "$folder holds Debian $(cat "$folder/etc/debian_version")"
[ $# -gt 0 ] || exit 0

mkdir -p "$folder/work"
if [ -d "$folder/work/.git" ]; then # what an earlier copy had and this one lacks
    (cd "$folder/work" && git ls-files -z --others --exclude-standard | xargs -0 --no-run-if-empty rm -f)
fi
(cd "$root" && git ls-files -z --cached --others --exclude-standard |
    tar --create --null --files-from=- --ignore-failed-read 2>/dev/null) | tar --extract --directory "$folder/work"
git -C "$folder/work" init --quiet  # some tests ask git which files there are
for file in resolv.conf hosts; do
    cp "/etc/$file" "$folder/etc/$file"
done
# pip trusts there what it trusts here, a company's proxy for one, and looks where it looks here.
certificates=${PIP_CERT:-/etc/ssl/certs/ca-certificates.crt}
[ ! -e "$certificates" ] || cp --dereference "$certificates" "$folder/etc/here.crt"
[ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$folder/etc/pip.conf"
# shellcheck disable=SC2016  # the inner shell expands
exec unshare --mount --propagation private bash -c '
    set -e
    folder=$1
    shift
    mount -t proc proc "$folder/proc"
    mount --rbind /dev "$folder/dev"
    exec chroot "$folder" env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
        LANG=C.UTF-8 TERM="${TERM:-dumb}" PIP_CERT=/etc/here.crt ${http_proxy:+http_proxy="$http_proxy"} \
        ${https_proxy:+https_proxy="$https_proxy"} sh -c "cd /work && exec \"\$@\"" sh "$@"
' bash "$folder" "$@"
