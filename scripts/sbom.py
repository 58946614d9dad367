"""Writes what the program fjr is made of as SPDX 2.3 (JSON):  scripts/sbom.py PROGRAM FILE

Debian's packages that it is built with are those of scripts/packages.sh, with the licences of docs/architecture.md; those
whose libraries it loads are read off the program. Versions are the ones installed here.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
BUILD_TOOLS = {"g++", "cmake", "ninja-build", "pkg-config", "ccache"}  # nothing of them is in the program
NO_LICENCE_SAID = "NOASSERTION"


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def built_with():
    listed = output("bash", "-c", 'source "$0"; printf "%s\\n" "${program_packages[@]}"', SOURCE / "scripts/packages.sh")
    return [name for name in listed.split() if name not in BUILD_TOOLS]


def licences():
    """Of each package in the table of docs/architecture.md."""
    table = (SOURCE / "docs/architecture.md").read_text().split("## Licences", 1)[1]
    rows = re.findall(r"^\| [^|]+ \| ([^|]+) \| [^|]+ \| ([^|]+) \|$", table, re.MULTILINE)
    return {name: licence for packages, licence in rows for name in packages.split(", ")}


def loaded_by(program):
    """The packages of the shared libraries that the loader finds for it."""
    files = re.findall(r"=> (/\S+)", output("ldd", program))
    paths = {path for file in files for path in (file, os.path.realpath(file), "/usr" + file)}  # as some packages name them
    found = subprocess.run(["dpkg", "-S", *sorted(paths)], capture_output=True, text=True).stdout
    return {line.split(":")[0] for line in found.splitlines() if not line.startswith("diversion ")}


def reference(name):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)


def package(name, licence):
    version, architecture = output("dpkg-query", "-W", "-f", "${Version} ${Architecture}", name).split()[:2]
    return {
        "SPDXID": reference(name),
        "name": name,
        "versionInfo": version,
        "supplier": "Organization: Debian",
        "downloadLocation": f"https://packages.debian.org/{name}",
        "filesAnalyzed": False,
        "licenseConcluded": NO_LICENCE_SAID,
        "licenseDeclared": licence,
        "copyrightText": f"see /usr/share/doc/{name}/copyright",
        "externalRefs": [{
            "referenceCategory": "PACKAGE-MANAGER",
            "referenceType": "purl",
            "referenceLocator": f"pkg:deb/debian/{name.replace('+', '%2B')}@{version.replace('+', '%2B').replace(':', '%3A')}"
                                f"?arch={architecture}",
        }],
    }


def document(program):
    known, built, loaded = licences(), built_with(), loaded_by(program)
    missing = [name for name in built if name not in known]
    if missing:
        sys.exit(f"the table of licences in docs/architecture.md has not: {', '.join(missing)}")
    version = output(program, "--version").strip()
    fjr = {
        "SPDXID": "SPDXRef-fjr",
        "name": "fjr",
        "versionInfo": version,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": NO_LICENCE_SAID,
        "licenseDeclared": NO_LICENCE_SAID,
        "copyrightText": "NOASSERTION",
    }
    names = sorted({*built, *loaded})
    packages = [fjr, *(package(name, known.get(name, NO_LICENCE_SAID)) for name in names)]
    relations = [("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-fjr")]
    relations += [("SPDXRef-fjr", "DEPENDS_ON", reference(name)) for name in names if name in loaded]
    relations += [(reference(name), "BUILD_DEPENDENCY_OF", "SPDXRef-fjr") for name in names if name in built]
    written = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", datetime.now().timestamp())), timezone.utc)
    contents = hashlib.sha256(json.dumps(packages).encode()).hexdigest()
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"fjr-{version}",
        "documentNamespace": f"https://spdx.org/spdxdocs/fjr-{version}-{contents}",
        "creationInfo": {"created": written.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: scripts/sbom.py"]},
        "packages": packages,
        "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations],
    }


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(json.dumps(document(sys.argv[1]), indent=1) + "\n")
