# SPDX-License-Identifier: Apache-2.0
# podman as root on any Linux, with control groups of either version and without a systemd around it.

containers_folder=$PWD/build/packages
mkdir -p "$containers_folder"
cat >"$containers_folder/containers.conf" <<'TEXT'
[containers]
default_ulimits = ["nofile=1024:1024","nproc=4096:4096"]
log_driver = "k8s-file"
[engine]
runtime = "runc"
cgroup_manager = "cgroupfs"
events_logger = "file"
[network]
network_backend = "netavark"
TEXT
export CONTAINERS_CONF=$containers_folder/containers.conf

# fresh_system NAME PACKAGE,...: the image localhost/NAME of this Debian release, with the package sources of this machine.
fresh_system() {
    local name=$1 sources
    podman image exists "localhost/$name" && return
    sources=$(find /etc/apt/sources.list.d -name '*.sources' -o -name '*.list' | head -1)
    mmdebstrap --quiet --variant=minbase ${2:+"--include=$2"} bookworm "$containers_folder/$name.tar" "$sources"
    podman import --quiet "$containers_folder/$name.tar" "localhost/$name"
    rm "$containers_folder/$name.tar"
}
