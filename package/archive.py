#!/usr/bin/env python3
"""Makes the archives that run on any Linux, from a build: archive.py BUILD DIST

fluidcarve-VERSION-linux-x86_64.tar.zst holds the program with all of its libraries, the loader and the C library too. The modules with their
libraries are archives of their own, to be unpacked over it. Beside them: SPDX lists of what is inside, and the add-on of Blender.
The same build gives the same bytes: files bear the time SOURCE_DATE_EPOCH.
"""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

from prebind import prebind

FONTS = [f"/usr/share/fonts/truetype/dejavu/{name}" for name in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf")]
HERE = pathlib.Path(__file__).parent


def output_of(*command, **more):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **more).stdout


def libraries_of(file):
    """The libraries that the loader opens for a file of the build, the loader among them: paths by name. Those of the build are left out."""
    listed = output_of("ldd", str(file))
    missing = re.findall(r"\s(\S+) => not found", listed)
    if missing:
        sys.exit(f"package: {file} needs {', '.join(missing)}, which the loader does not find; install them")
    found = dict(re.findall(r"\s(\S+) => (/\S+)", listed))
    for loader in re.findall(r"\s(/\S*/ld-linux\S+)", listed):
        found[os.path.basename(loader)] = loader
    return {name: path for name, path in found.items() if not name.startswith("libfluidcarve_")}


def packages_of(files):
    """The packages of Debian that files are of, by file. Older packages name their files without /usr in front."""
    names = {}
    for file in files:
        for path in (file, os.path.realpath(file)):
            names.setdefault(path, file)
            names.setdefault(path.removeprefix("/usr"), file)
    listed = subprocess.run(["dpkg-query", "-S", *names], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = {names[path]: package.split(",")[0] for package, path in (line.split(": ", 1) for line in listed.splitlines()) if path in names}
    for file in files:
        if file not in found:
            sys.exit(f"package: {file} is of no package, so its licence is not known")
    return found


class Tree:
    """The files of one archive, in a folder that it is made from."""

    def __init__(self, scratch, name, title):
        self.name, self.title = name, title
        self.top = pathlib.Path(scratch) / name / title
        self.packages = {}  # package: its files here

    def put(self, source, to, package=None):
        target = self.top / to
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        shutil.copymode(source, target)
        if package:
            self.packages.setdefault(package, []).append(to)

    def put_libraries(self, libraries):
        packages = packages_of(libraries.values())
        for name, path in sorted(libraries.items()):
            to = "loader/fluidcarve" if name.startswith("ld-linux") else f"libraries/{name}"
            self.put(os.path.realpath(path), f"lib/fluidcarve/{to}", packages[path])
            if name.startswith("libopenvdb.") and prebind(self.top / f"lib/fluidcarve/{to}") == 0:
                sys.exit(f"package: nothing could be bound in {path}, so that a start would be slow")

    def put_licences(self):
        for package in self.packages:
            self.put(f"/usr/share/doc/{package.split(':')[0]}/copyright", f"share/doc/fluidcarve/licences/{package.split(':')[0]}")


def spdx_of(tree, version, made):
    """A list of what an archive holds, as SPDX 2.3: fluidcarve, and each package of Debian with its files. Licences are the texts of the packages."""
    packages, texts, relations, files = [], [], [], {}

    nothing_concluded = {"licenseConcluded": "NOASSERTION", "copyrightText": "NOASSERTION"}

    def reference_of(name):
        return "SPDXRef-Package-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)

    def add(name, **facts):
        packages.append({"SPDXID": reference_of(name), "name": name, **nothing_concluded, **facts})

    add("fluidcarve", versionInfo=version, licenseDeclared="Apache-2.0", downloadLocation="NOASSERTION", filesAnalyzed=False)
    relations.append({"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": reference_of("fluidcarve")})
    form = "${Version}\t${source:Package}\t${source:Version}\t${Architecture}\t${binary:Package}\n"
    facts = (line.split("\t") for line in output_of("dpkg-query", "-W", "-f", form, *tree.packages).splitlines())
    for number, source, source_version, machine, package in sorted(facts, key=lambda each: each[-1]):
        inside = tree.packages[package]
        name = package.split(":")[0]
        text = pathlib.Path(f"/usr/share/doc/{name}/copyright").read_text(errors="replace")
        licence = "LicenseRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)
        named = sorted(set(re.findall(r"^License:[ \t]*(\S.*?)[ \t]*$", text, re.MULTILINE)))
        texts.append({"licenseId": licence, "name": f"licences of {name}", "extractedText": text})
        sums = []
        for path in sorted(inside):
            bytes_ = (tree.top / path).read_bytes()
            reference = "SPDXRef-File-" + re.sub(r"[^A-Za-z0-9.-]", "-", path)
            sums.append((hashlib.sha1(bytes_).hexdigest(), hashlib.sha256(bytes_).hexdigest()))
            checksums = [{"algorithm": kind, "checksumValue": value} for kind, value in zip(("SHA1", "SHA256"), sums[-1])]
            files[reference] = {"SPDXID": reference, "fileName": f"./{path}", "checksums": checksums, **nothing_concluded}
            relations.append({"spdxElementId": reference_of(name), "relationshipType": "CONTAINS", "relatedSpdxElement": reference})
        add(
            name,
            versionInfo=number,
            licenseDeclared=licence,
            licenseComments="named in it: " + "; ".join(named) if named else "see the text",
            downloadLocation=f"https://snapshot.debian.org/package/{source}/{source_version}/",
            externalRefs=[
                {
                    "referenceCategory": "PACKAGE-MANAGER",
                    "referenceType": "purl",
                    "referenceLocator": f"pkg:deb/debian/{name}@{number}?arch={machine}",
                }
            ],
            filesAnalyzed=True,
            packageVerificationCode={"packageVerificationCodeValue": hashlib.sha1("".join(sorted(one for one, _ in sums)).encode()).hexdigest()},
        )
        relations.append({"spdxElementId": reference_of("fluidcarve"), "relationshipType": "DEPENDS_ON", "relatedSpdxElement": reference_of(name)})
    content = json.dumps([packages, files], sort_keys=True)
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": tree.title + ("" if tree.name == "program" else f"-{tree.name}"),
        "documentNamespace": f"https://spdx.org/spdxdocs/{tree.title}-{tree.name}-{hashlib.sha256(content.encode()).hexdigest()}",
        "creationInfo": {"created": made, "creators": [f"Tool: fluidcarve-{version}"]},
        "packages": packages,
        "files": list(files.values()),
        "relationships": relations,
        "hasExtractedLicensingInfos": texts,
    }


def pack(tree, dist, epoch):
    """Writes DIST/TITLE[-NAME].tar.zst, whole or not at all."""
    target = dist / (tree.title + ("" if tree.name == "program" else f"-{tree.name}") + ".tar.zst")
    aside = target.with_suffix(".part")
    tar = ["tar", "--create", "--sort=name", "--format=gnu", f"--mtime=@{epoch}", "--owner=0", "--group=0", "--numeric-owner", "--mode=go=rX,u+rw,a-s"]
    command = f'set -o pipefail; "$@" | zstd -q -T0 -12 -f -o "{aside}"'
    subprocess.run(["bash", "-c", command, "pack", *tar, "-C", str(tree.top.parent), tree.title], check=True)
    aside.rename(target)
    return target


def pack_addon(version, dist, epoch):
    """Writes DIST/fluidcarve-blender-VERSION.zip: the add-on of Blender with the package of Python in it, as Blender installs it."""
    top = HERE.parent
    files = {f"fluidcarve/{file.name}": file for file in (top / "blender/fluidcarve").iterdir() if file.suffix in (".py", ".toml")}
    files.update({f"fluidcarve/package/{file.name}": file for file in (top / "python/fluidcarve").glob("*.py")})
    files["fluidcarve/LICENSE"] = top / "LICENSE"
    target = dist / f"fluidcarve-blender-{version}.zip"
    aside = target.with_suffix(".part")
    with zipfile.ZipFile(aside, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in sorted(files.items()):
            archive.writestr(zipfile.ZipInfo(name, time.gmtime(epoch)[:6]), file.read_bytes(), zipfile.ZIP_DEFLATED)
    aside.rename(target)


def main(build, dist):
    version = output_of(str(build / "fluidcarve"), "--version").split()[-1]
    epoch = int(os.environ["SOURCE_DATE_EPOCH"])
    made = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(epoch))
    title = f"fluidcarve-{version}-linux-x86_64"
    dist.mkdir(parents=True, exist_ok=True)
    pack_addon(version, dist, epoch)
    with tempfile.TemporaryDirectory(dir=dist) as scratch:
        trees = [Tree(scratch, "program", title)]
        program = trees[0]
        subprocess.run(["cmake", "--install", str(build), "--strip", "--prefix", str(program.top)], check=True, stdout=subprocess.DEVNULL)
        (program.top / "lib/fluidcarve/program").mkdir()
        (program.top / "bin/fluidcarve").rename(program.top / "lib/fluidcarve/program/fluidcarve")
        program.put(build / "fluidcarve_launcher", "bin/fluidcarve")
        subprocess.run(["strip", str(program.top / "bin/fluidcarve")], check=True)
        # Parts of these libraries are in the launcher.
        static = [output_of("c++", f"-print-file-name={name}").strip() for name in ("libc.a", "libstdc++.a")]
        program.packages.update((package, ["bin/fluidcarve"]) for package in packages_of(static).values())
        base = libraries_of(build / "fluidcarve")
        program.put_libraries(base)
        for font, package in packages_of(FONTS).items():
            program.put(font, f"lib/fluidcarve/fonts/{os.path.basename(font)}", package)
        for recipe in sorted((HERE / "recipes").iterdir()):
            target = program.top / "share/fluidcarve/recipes" / recipe.name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(recipe.read_text().replace("@VERSION@", version))
        for module in sorted(build.glob("fluidcarve_*.so")):
            tree = Tree(scratch, module.stem.removeprefix("fluidcarve_"), title)
            stripped = program.top / "lib/fluidcarve" / module.name
            tree.put(stripped, f"lib/fluidcarve/{module.name}")
            stripped.unlink()
            tree.put_libraries({name: path for name, path in libraries_of(module).items() if name not in base})
            trees.append(tree)
        for tree in trees:
            tree.put_licences()
            listed = tree.top / f"share/doc/fluidcarve/{tree.name}.spdx.json"
            listed.write_text(json.dumps(spdx_of(tree, version, made), indent=1) + "\n")
            archive = pack(tree, dist, epoch)
            shutil.copyfile(listed, archive.with_name(archive.name.replace(".tar.zst", ".spdx.json")))


main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
