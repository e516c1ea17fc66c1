#!/usr/bin/env bash
# Runs the archives of a folder as an artist would: check.sh DIST [SUITE...]
# as a user without rights, in a folder with a space in its name, with LD_LIBRARY_PATH at broken libraries of the same names; on this machine and,
# as root, in bare chroots of Debian's SUITEs (build-platforms/SUITE/bare, made by debootstrap).
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

cat >"$scratch/try.sh" <<'TRY'
set -euo pipefail
cd "$1"
place=$(echo "$1/my tools"/*)
fluidcarve() {
    LD_LIBRARY_PATH=$broken "$place/bin/fluidcarve" "$@" 2>messages || { cat messages >&2; echo "failed: fluidcarve $*" >&2; return 1; }
    if grep -iE 'error|warning: .*(font|librar)' messages >&2; then echo "said: fluidcarve $*" >&2; return 1; fi
}
broken=$1/broken
mkdir "$2" && cd "$2"
plume=$1/plume/plume.####.vdb pipelines=$place/share/fluidcarve/pipelines
began=$(date +%s%N)
fluidcarve carve "$plume" -20% -o 'carved.####.vdb' --sheet carved.png --work work
echo "$2: the first result took $((($(date +%s%N) - began) / 1000000)) ms"
fluidcarve carve "$1/images/chelsea.png" -20% -o cat.png --work work
fluidcarve carve "$1/river/riverbank.obj" -10% -o bank.obj --work work
results=(--set "sim=$plume" --set "seams=seams.vdb" --set "sheet=sheet.png" --work work)
fluidcarve view "$pipelines/plume.yaml" "${results[@]}" --set 'out=plume.####.vdb' -o view.html >view.txt
fluidcarve farm local "$pipelines/plume.yaml" "${results[@]}" --set 'out=plume.####.vdb' -j 2
fluidcarve run "$pipelines/plume_ax.yaml" "${results[@]}" --set 'out=ax.####.vdb'
fluidcarve run "$1/plugin/sparkle/example.yaml" --allow-plugins --set "volumes=$plume" --set frames=51-52 --set 'out=plugin.####.vdb' --work work
for result in carved.0056.vdb carved.png cat.png bank.obj view.html plume.0056.vdb ax.0056.vdb plugin.0052.vdb; do test -s "$result"; done
echo "$2: VDB, image, mesh, view, farm, AX and plugin work"
TRY
chmod -R a+rX "$scratch"
chmod a+rwx "$scratch"
"${user[@]}" bash "$scratch/try.sh" "$scratch" here

for suite in "${@:2}"; do
    root=build-platforms/$suite/bare
    [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase "$suite" "$root" >/dev/null
    mkdir -p "$root/$scratch"
    # shellcheck disable=SC2016
    unshare -m bash -c 'mount -t proc proc "$1/proc" && mount --bind "$2" "$1$2" &&
        exec chroot --userspec=1234:1234 "$1" /usr/bin/env -i PATH=/usr/bin:/bin bash "$2/try.sh" "$2" "$3"' _ "$root" "$scratch" "$suite"
    rmdir "$root/$scratch"
done
