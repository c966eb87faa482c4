# shellcheck shell=bash
# What the parts share; each part sources it first. The working directory is the repository's root.
set -euo pipefail

# Where the tools of the system are, for users whose PATH leaves them out, and where rustup puts its own.
export PATH="$PATH:/usr/sbin:/sbin:${CARGO_HOME:-$HOME/.cargo}/bin"

say() { printf '\n-- %s\n' "$*"; }

die() {
    echo "tests/run: $*" >&2
    exit 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# need PACKAGE...: installs those Debian packages that are missing.
need() {
    local package missing=()
    for package in "$@"; do
        # A tool that came another way (python3-venv of a hand-built Python, say) will do.
        case $package in
        python3-venv) python3 -c 'import ensurepip, venv' 2>/dev/null && continue ;;
        gcc) command -v cc >/dev/null && continue ;;
        g++) command -v c++ >/dev/null && continue ;;
        busybox-static) command -v busybox >/dev/null && ! ldd "$(command -v busybox)" >/dev/null 2>&1 && continue ;;
        iproute2) command -v ip >/dev/null && continue ;;
        can-utils) command -v candump >/dev/null && command -v cansend >/dev/null && continue ;;
        qemu-system-x86) command -v qemu-system-x86_64 >/dev/null && continue ;;
        chromium) command -v chromium chromium-browser google-chrome >/dev/null && continue ;;
        qemu-system-arm) command -v qemu-system-arm >/dev/null && continue ;;
        esac
        dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed ||
            missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    say "installing ${missing[*]}"
    command -v apt-get >/dev/null || die "install these first: ${missing[*]}"
    as_root apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq --no-install-recommends "${missing[@]}"
}

# need_rust [COMPONENT...]: the toolchain that rust-toolchain.toml names, and a C compiler, which cargo
# links with.
need_rust() {
    need gcc libc6-dev
    command -v cargo >/dev/null || die "cargo is missing: install Rust with https://rustup.rs"
    # Another way to have Rust is as good, as long as it brings the components.
    command -v rustup >/dev/null || return 0
    rustup show active-toolchain >/dev/null 2>&1 || rustup toolchain install
    local component installed
    installed=$(rustup component list --installed)
    for component in "$@"; do
        [[ $'\n'$installed == *$'\n'"$component"* ]] || rustup component add "$component"
    done
}

# build_tests TEST [ARGUMENT...]: `canter`, which they run, and the programs of that test.
#
# In one build of all packages: what two of them ask of a library (its features) differs, and each build of one
# alone would make that library anew, and all that needs it.
build_tests() {
    local name=$1
    shift
    cargo build --locked --release --bin canter --test "$name" "$@"
}

# What building and measuring images takes.
need_images() { need_rust clippy llvm-tools rust-std-thumbv7em-none-eabihf; }

# python_with REQUIREMENTS VENV: a Python with those packages, made anew when they change.
python_with() {
    need python3-venv
    local requirements=$1 venv=$2
    if ! cmp -s "$requirements" "$venv/requirements.txt"; then
        say "making $venv"
        rm -rf "$venv"
        python3 -m venv "$venv"
        "$venv/bin/pip" install --quiet --no-cache-dir --disable-pip-version-check -r "$requirements"
        cp "$requirements" "$venv/requirements.txt"
    fi
}

# The Python with the packages of tests/requirements.txt; tests find it in CANTER_PYTHON.
need_python() {
    python_with tests/requirements.txt "$CARGO_TARGET_DIR/venv"
    export CANTER_PYTHON=$CARGO_TARGET_DIR/venv/bin/python
}

# image_cargo SUBCOMMAND ARGUMENT...: cargo for the device; a warning is an error.
# It reads the output for that: RUSTFLAGS="-D warnings" would replace the flags of .cargo/config.toml.
image_cargo() {
    say "cargo $*"
    local log=$CARGO_TARGET_DIR/image.log
    CARGO_TERM_COLOR=never cargo "$@" --locked --target thumbv7em-none-eabihf 2>&1 | tee "$log"
    # What cargo says of other people's packages is not ours to mend.
    if grep '^warning' "$log" | grep -qv 'by a future version of Rust'; then die "there are warnings"; fi
}
