# Sourced by the scripts of this folder.
# shellcheck shell=bash

# What takes long to make is kept there, outside the checkout; delete it to begin anew.
cache=${XDG_CACHE_HOME:-${HOME:?is not set}/.cache}/fenics-contact-ci

stage() {
    local name=$1
    shift
    printf '\n=== %s: %s\n' "$name" "$*"
    local started=$SECONDS
    if ! "$@"; then
        printf '\n=== %s FAILED after %d s\n' "$name" $((SECONDS - started))
        exit 1
    fi
    printf '=== %s passed in %d s\n' "$name" $((SECONDS - started))
}

# quietly NAME COMMAND...: the output goes to a file, and is shown when the command fails.
quietly() {
    local log=$cache/logs/$1.log
    shift
    mkdir -p "$cache/logs"
    "$@" >"$log" 2>&1 && return
    printf '%s failed; the last lines of %s:\n' "$1" "$log"
    tail -n 40 "$log"
    return 1
}

is_root() { [ "$(id -u)" = 0 ]; }

# apt_install PROGRAM PACKAGES...: unless the program is there.
apt_install() {
    command -v "$1" >/dev/null && return
    if ! is_root || ! command -v apt-get >/dev/null; then
        echo "$1 is missing; install: ${*:2}"
        return 1
    fi
    mkdir -p "$cache"
    { # one at a time: apt gives up where another one is at work
        flock 8 &&
            quietly "apt-$1" apt-get update 8>&- &&
            quietly "apt-$1" env DEBIAN_FRONTEND=noninteractive \
                apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=300 "${@:2}" 8>&-
    } 8>"$cache/apt-lock"
}

# Compiled forms that nothing has loaded for two weeks go: sources and options are part of their names,
# so that those of earlier versions would stay.
forget_old_forms() {
    local library name
    [ -d "$1" ] || return 0
    find "$1" -name 'libffcx_*.so' -atime +14 | while read -r library; do
        name=${library##*/}
        rm -f "${library%/*}/${name%%.*}".*
    done
}

# A bare Debian 13 as a tar file, with what this machine needs to reach its mirror.
make_base() {
    [ -f "$cache/trixie.tar" ] && return
    is_root || { echo "only root can make a base system" && return 1; }
    apt_install debootstrap debootstrap debian-archive-keyring || return 1
    local root=$cache/base mirror
    # shellcheck disable=SC2016
    # the mirror of this machine, where it is a Debian; else debootstrap's own
    mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 2>/dev/null |
        sed -n '/security/!s/^Debian //p' | head -n 1)
    rm -rf "$root"
    mkdir -p "$root"
    quietly debootstrap debootstrap --variant=minbase trixie "$root" ${mirror:+"$mirror"} || return 1
    # proxies, certificates, and how strictly the mirror's dates are taken
    apt-config dump | grep -E '^Acquire::(https?|Check-|Retries|ForceIPv)' \
        >"$root/etc/apt/apt.conf.d/90host"
    if [ -f /etc/ssl/certs/ca-certificates.crt ]; then
        mkdir -p "$root/etc/ssl/certs"
        cp -L /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs"
    fi
    rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
    # not /dev, which containers get from the engine
    tar -C "$root" --numeric-owner --exclude './dev/*' -cf "$cache/trixie.tar.new" . &&
        mv "$cache/trixie.tar.new" "$cache/trixie.tar" && rm -rf "$root"
}

# How the Tiny C Compiler comes into the image. dpkg leaves out files such as its library there, and the
# stacks of what it compiles are executable, which glibc refuses without the variable.
install_tcc='apt-get install -y --no-install-recommends -o Dpkg::Options::="--path-include=/usr/lib/*/tcc/*" tcc'
tcc_variables=(CC=tcc GLIBC_TUNABLES=glibc.rtld.execstack=2)
