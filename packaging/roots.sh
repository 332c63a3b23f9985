# SPDX-License-Identifier: Apache-2.0
# Fresh Debian systems in folders, to build and to try in. Sourced by scripts that run as root in the project's folder.

roots_folder=$PWD/build/roots
mirror=${ASIP_MIRROR:-http://deb.debian.org/debian}
mkdir -p "$roots_folder"

# codename NUMBER
codename() {
    case $1 in
    12) echo bookworm ;;
    13) echo trixie ;;
    *) echo "$1" ;; # testing
    esac
}

# GNU's name of a Debian architecture, and that of qemu-user.
machine() {
    case $1 in
    amd64) echo x86_64-linux-gnu ;;
    arm64) echo aarch64-linux-gnu ;;
    armhf) echo arm-linux-gnueabihf ;;
    *) return 1 ;;
    esac
}
emulator() {
    case $1 in
    amd64) ;;
    arm64) echo qemu-aarch64-static ;;
    armhf) echo qemu-arm-static ;;
    esac
}

# make_root NAME RELEASE PACKAGE,... [FOREIGN_ARCHITECTURE]: the folder build/roots/NAME, with nothing of an
# earlier one: Debian's archive has other packages each day.
make_root() {
    local name=$1 release=$2 packages=$3 root=$roots_folder/$1
    rm -rf --one-file-system "${roots_folder:?}/${name:?}"
    mmdebstrap --quiet --mode=root --variant=apt --aptopt='Acquire::Languages "none"' --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt=force-unsafe-io \
        --architectures="$(dpkg --print-architecture)${4:+,$4}" ${packages:+"--include=$packages"} "$(codename "$release")" "$root" "$mirror" || return
    printf '127.0.0.1 localhost\n' >"$root/etc/hosts"
}

# in_root NAME COMMAND...: in the root's folder /asip, with processes and mounts of its own, which end with it. Where
# ROOT_SOURCE is set, that folder is seen at /asip; where ROOT_ALONE is, the network is its own loopback and nothing more.
in_root() {
    local root=$roots_folder/$1
    shift
    mkdir -p "$root/asip"
    cp --dereference /etc/resolv.conf "$root/etc/resolv.conf"
    unshare --mount --pid ${ROOT_ALONE:+--net} --fork --kill-child bash -c '
        set -e
        root=$1
        shift
        mount --bind "$root" "$root"
        mount -t proc proc "$root/proc"
        mount --rbind /sys "$root/sys"
        mount --rbind /dev "$root/dev"
        [ -z "${ROOT_ALONE:-}" ] || ip link set lo up
        [ -z "${ROOT_SOURCE:-}" ] || mount --bind "$ROOT_SOURCE" "$root/asip"
        exec chroot "$root" /bin/bash -c "cd /asip && exec \"\$@\"" - "$@"' - "$root" "$@"
}

# What a build for another architecture needs of this one; packaging/install_build_dependencies adds the libraries.
packages_to_cross() { # packages_to_cross ARCHITECTURE
    echo "build-essential,crossbuild-essential-$1,qemu-user-static"
}

# For cmake, as debhelper calls it.
cross_options() { # cross_options ARCHITECTURE
    local machine
    machine=$(machine "$1")
    echo "-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=${machine%%-*} -DCMAKE_C_COMPILER=$machine-gcc -DCMAKE_CXX_COMPILER=$machine-g++" \
        "-DPKG_CONFIG_EXECUTABLE=/usr/bin/$machine-pkg-config -DCMAKE_CROSSCOMPILING_EMULATOR=/usr/bin/$(emulator "$1")"
}
