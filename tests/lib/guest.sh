# shellcheck shell=bash
# An emulated machine with Debian's kernel, which has CAN whatever the host's kernel lacks.
#
# Its time is counted in instructions, one a nanosecond: a slow host makes its seconds longer, and no test
# sees that. It waits like any machine, so that what it reads of the host takes no time of its own either.

# The modules that it needs: its root and CAN.
guest_modules=(drivers/virtio/virtio drivers/virtio/virtio_ring drivers/virtio/virtio_pci
    drivers/virtio/virtio_pci_legacy_dev drivers/virtio/virtio_pci_modern_dev net/9p/9pnet net/9p/9pnet_virtio
    fs/netfs/netfs fs/fscache/fscache fs/9p/9p
    net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan)

# find_guest: sets `package` to the name of Debian's package with the present kernel, and `guest` to the place
# that it is unpacked to; fails where it is not.
find_guest() {
    package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image-/ { print $2; exit }')
    guest=$CARGO_TARGET_DIR/guest/$package
    [ -n "$package" ] && [ -f "$guest/vmlinux" ]
}

unpack_guest() {
    local unpacked module
    say "unpacking $package"
    unpacked=$(mktemp -d "$CARGO_TARGET_DIR/unpacked.XXXXXX")
    mkdir -p "$unpacked/kept/modules"
    (cd "$unpacked" && apt-get download -qq -o APT::Sandbox::User=root "$package" && dpkg -x ./*.deb .)
    python3 tests/guest/vmlinux.py "$unpacked"/boot/vmlinuz-* "$unpacked/kept/vmlinux"
    for module in "${guest_modules[@]}"; do
        cp "$unpacked"/lib/modules/*/kernel/"$module.ko" "$unpacked/kept/modules/"
    done
    mkdir -p "${guest%/*}"
    rm -rf "$guest"
    mv "$unpacked/kept" "$guest"
    rm -rf "$unpacked"
}

# need_guest: QEMU, a kernel and its first file system. Nothing is installed of the kernel: it is unpacked.
need_guest() {
    need qemu-system-x86 busybox-static python3
    if ! find_guest; then
        # Lists that are old name a kernel that is no longer there.
        as_root apt-get update -qq
        find_guest || true
        [ -n "$package" ] || die "there is no package linux-image-amd64: run this on Debian, or on a kernel with CAN"
        [ -f "$guest/vmlinux" ] || unpack_guest
    fi
    local root=$guest/root
    rm -rf "$root"
    mkdir -p "$root"/{bin,host}
    cp "$(command -v busybox)" "$root/bin/busybox"
    cp tests/guest/init "$root/init"
    cp -r "$guest/modules" "$root/"
    (cd "$root" && find . | busybox cpio -o -H newc 2>/dev/null | gzip -1) >"$guest/initramfs"
}

# guest_command SCRIPT: sets `command` to what runs SCRIPT in the machine, as root of the host's file tree.
#
# A plain processor is emulated faster than one with every extension.
guest_command() {
    command=(qemu-system-x86_64 -machine pc -cpu qemu64 -m 1024 -icount shift=0
        -nodefaults -no-user-config -display none -serial stdio -monitor none -no-reboot
        -kernel "$guest/vmlinux" -initrd "$guest/initramfs"
        -append "console=ttyS0 quiet panic=-1 mitigations=off tsc=reliable script=$1"
        -virtfs "local,path=/,mount_tag=host,security_model=none,multidevs=remap")
}
