#!/usr/bin/env bash
# Runs what `./dev package` made as an artist would: check.sh DIST [SUITE...]
# The archives: as a user without rights, in a folder with a space in its name, with LD_LIBRARY_PATH at broken libraries of the same names; on this
# machine and, as root, in bare chroots of Debian's SUITEs (build-platforms/SUITE/bare, made by debootstrap).
# The package of Debian: by lintian, and, if this machine's suite is one of SUITEs, in a copy of its chroot: installed, used by such a user, removed.
set -euo pipefail
cd "$(dirname "$0")/.."
dist=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
user=()
[ "$(id -u)" -ne 0 ] || user=(setpriv --reuid 1234 --regid 1234 --clear-groups)

mkdir "$scratch/my tools" "$scratch/broken" "$scratch/plugin"
for archive in "$dist"/*.tar.zst; do tar --zstd -xf "$archive" -C "$scratch/my tools"; done
place=$(echo "$scratch/my tools"/*)
for library in "$place"/lib/fluidcarve/libraries/* ; do echo broken >"$scratch/broken/${library##*/}"; done
for sequence in plume images river; do cp -r "tests/data/$sequence" "$scratch"; done
# The plugin of `new-node`, against the headers in the archive.
"$place/bin/fluidcarve" new-node acme.sparkle --folder "$scratch/plugin/sparkle" >/dev/null
cmake -S "$scratch/plugin/sparkle" -B "$scratch/plugin/sparkle/build" -G Ninja -DCMAKE_PREFIX_PATH="$place" >/dev/null
cmake --build "$scratch/plugin/sparkle/build" --target acme_sparkle >/dev/null

# try.sh SCRATCH NAME [PREFIX]: runs the archive, or what is installed at PREFIX.
cat >"$scratch/try.sh" <<'TRY'
set -euo pipefail
cd "$1"
place=${3:-$(echo "$1/my tools"/*)}
broken=$1/broken
[ $# -lt 3 ] || broken=
fluidcarve() {
    LD_LIBRARY_PATH=$broken "$place/bin/fluidcarve" "$@" 2>messages || { cat messages >&2; echo "failed: fluidcarve $*" >&2; return 1; }
    if grep -iE 'error|warning: .*(font|librar)' messages >&2; then echo "said: fluidcarve $*" >&2; return 1; fi
}
name=$2
fail() { echo "$name: $*" >&2; exit 1; }
[ "$(id -u)" -ne 0 ] || fail "root runs it"
[ -z "$broken" ] || ! LD_LIBRARY_PATH=$broken /bin/ls >/dev/null 2>&1 || fail "the libraries in $broken are not broken"
mkdir "$name" && cd "$name"
plume=$1/plume/plume.####.vdb pipelines=$place/share/fluidcarve/pipelines
began=$(date +%s%N)
fluidcarve carve "$plume" -20% -o 'carved.####.vdb' --sheet carved.png --work work
first=$((($(date +%s%N) - began) / 1000000))
# What a start takes of a processor is told alone: it is up to the machine, and to what else that does.
starts() { for _ in {1..20}; do LD_LIBRARY_PATH=$broken "$place/bin/fluidcarve" --version >/dev/null; done; }
TIMEFORMAT='%3U %3S'
start=$({ time starts; } 2>&1 | tr -d . | { read -r user system && echo $(((10#$user + 10#$system) / 20)); })
echo "$name: the first result took $first ms, a start $start ms of a processor"
[ $first -lt 20000 ] || fail "the first result takes more than 20 s"
fluidcarve carve "$1/images/chelsea.png" -20% -o cat.png --work work
fluidcarve carve "$1/river/riverbank.obj" -10% -o bank.obj --work work
results=(--set "sim=$plume" --set "seams=seams.vdb" --set "sheet=sheet.png" --work work)
fluidcarve view "$pipelines/plume.yaml" "${results[@]}" --set 'out=plume.####.vdb' -o view.html >view.txt
fluidcarve farm local "$pipelines/plume.yaml" "${results[@]}" --set 'out=plume.####.vdb' -j 2
fluidcarve run "$pipelines/plume_ax.yaml" "${results[@]}" --set 'out=ax.####.vdb'
fluidcarve run "$1/plugin/sparkle/example.yaml" --allow-plugins --set "volumes=$plume" --set frames=51-52 --set 'out=plugin.####.vdb' --work work
for result in carved.0056.vdb carved.png cat.png bank.obj view.html plume.0056.vdb ax.0056.vdb plugin.0052.vdb; do
    test -s "$result" || fail "$result was not written"
done
echo "$name: VDB, image, mesh, view, farm, AX and plugin work"
TRY
# What is new after all of it is a rest, but for what apt and dpkg keep for themselves.
cat >"$scratch/deb.sh" <<'TRY'
set -euo pipefail
package=$1/package.deb
files() { find / -xdev \( -path /proc -o -path "$1" -o -path /var/log -o -path /var/cache -o -path /var/lib/apt \) -prune -o -print | sort; }
apt-get update -qq
apt-get satisfy -y -qq -o Dpkg::Use-Pty=0 --no-install-recommends "$(dpkg-deb -f "$package" Depends)" >/dev/null
files "$1" >"$1/before"
apt-get install -y -qq -o Dpkg::Use-Pty=0 "$package" >/dev/null
setpriv --reuid 1234 --regid 1234 --clear-groups bash "$1/try.sh" "$1" package /usr
for folder in python blender; do
    mkdir "/usr/share/fluidcarve/$folder/fluidcarve/__pycache__"
    touch "/usr/share/fluidcarve/$folder/fluidcarve/__pycache__/kept.pyc"
done
apt-get purge -y -qq -o Dpkg::Use-Pty=0 fluidcarve >/dev/null
files "$1" >"$1/after"
diff "$1/before" "$1/after"
echo "package: installed, used and removed without a rest"
TRY
chmod -R a+rX "$scratch"
chmod a+rwx "$scratch"
"${user[@]}" bash "$scratch/try.sh" "$scratch" here

# Runs a command in a chroot that sees the scratch folder.
inside() {  # inside ROOT COMMAND...
    mkdir -p "$1$scratch"
    # shellcheck disable=SC2016
    unshare -m bash -c 'mount -t proc proc "$1/proc" && mount --bind "$2" "$1$2" &&
        exec chroot "$1" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "${@:3}"' _ "$1" "$scratch" "${@:2}"
    rmdir "$1$scratch"
}

lintian --fail-on error "$dist"/*.deb
for suite in "${@:2}"; do
    root=build-platforms/$suite/bare
    mkdir -p "${root%/*}"
    [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase "$suite" "$root" >/dev/null
    inside "$root" setpriv --reuid 1234 --regid 1234 --clear-groups bash "$scratch/try.sh" "$scratch" "$suite"
    [ "$suite" = "$(. /etc/os-release && echo "$VERSION_CODENAME")" ] || continue
    rm -rf "$root.package"
    cp -a "$root" "$root.package"
    cp "$dist"/*.deb "$scratch/package.deb"
    inside "$root.package" bash "$scratch/deb.sh" "$scratch"
    rm -rf "$root.package"
done
