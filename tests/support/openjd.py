"""A scheduler for job bundles of Open Job Description 2023-09, as far as fluidcarve writes them.

    openjd.py SCHEMA BUNDLE tasks                 checks the bundle and prints a line for each task: step, frames
    openjd.py SCHEMA BUNDLE run [FROM=TO...]      checks it and runs all tasks, with each path that begins with FROM moved to TO

Checks what a JSON schema can't: that names are unique, needs are steps, and references to parameters lead to one.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

import jsonschema


def fail(message):
    sys.exit(f"{sys.argv[2]}: {message}")


def integers(expression):
    """All values of a range expression, in order."""
    out = []
    for part in expression.split(","):
        first, last, step = re.fullmatch(r"\s*(-?\d+)(?:\s*-\s*(-?\d+)(?::(\d+))?)?\s*", part).groups()
        out += range(int(first), int(last or first) + 1, int(step or 1))
    if len(set(out)) != len(out):
        fail(f"the ranges of {expression} overlap")
    return sorted(out)


def expression(values):
    """A range expression of the values that writes steps where there are some, as schedulers do."""
    steps = {b - a for a, b in zip(values, values[1:])}
    if len(values) > 1 and len(steps) == 1:
        step = steps.pop()
        return f"{values[0]}-{values[-1]}" + (f":{step}" if step > 1 else "")
    return ",".join(str(value) for value in values)


def tasks(step):
    """The parameters of each task of a step."""
    if "parameterSpace" not in step:
        return [{}]
    definitions = step["parameterSpace"]["taskParameterDefinitions"]
    if definitions[0]["type"] == "CHUNK[INT]":
        (chunked,) = definitions
        values, most = integers(chunked["range"]), chunked["chunks"]["defaultTaskCount"]
        return [{chunked["name"]: expression(values[at : at + most])} for at in range(0, len(values), most)]
    names = [definition["name"] for definition in definitions]
    if step["parameterSpace"]["combination"] != "(" + ", ".join(names) + ")":
        fail(f"{step['name']}: the combination does not join all parameters")
    if len({len(definition["range"]) for definition in definitions}) != 1:
        fail(f"{step['name']}: its parameters have lists of different lengths")
    return [dict(zip(names, map(str, values))) for values in zip(*(definition["range"] for definition in definitions))]


def resolved(text, values):
    """A format string with its references replaced."""
    rest = re.sub(r"\{\{\s*([A-Za-z0-9_.]+)\s*\}\}", "", text)
    if "{{" in rest or "}}" in rest:
        fail(f"braces that refer to nothing: {text}")

    def value(match):
        if match[1] not in values:
            fail(f"there is no {match[1]}, to which this refers: {text}")
        return values[match[1]]

    return re.sub(r"\{\{\s*([A-Za-z0-9_.]+)\s*\}\}", value, text)


def main():
    schema, bundle, verb, *moves = sys.argv[1:]
    template = json.load(open(os.path.join(bundle, "template.json")))
    jsonschema.Draft7Validator(json.load(open(schema))).validate(template)
    given = {each["name"]: each["value"] for each in json.load(open(os.path.join(bundle, "parameter_values.json")))["parameterValues"]}
    references = json.load(open(os.path.join(bundle, "asset_references.json")))["assetReferences"]

    resolved(template["name"], {})
    defined = [definition["name"] for definition in template["parameterDefinitions"]]
    if len(set(defined)) != len(defined) or set(defined) != set(given):
        fail("parameters are named twice, or have no value")
    for definition in template["parameterDefinitions"]:
        name, path = definition["name"], given[definition["name"]]
        if os.path.normpath(os.path.join(os.path.abspath(bundle), definition["default"])) != os.path.normpath(path):
            fail(f"the default of {name} is not where its value is")
        folder = definition["objectType"] == "DIRECTORY"
        if "IN" in definition["dataFlow"] and path not in references["inputs"]["directories" if folder else "filenames"]:
            fail(f"{name} is an input, but travels not with the job")
        if "OUT" in definition["dataFlow"] and (path if folder else os.path.dirname(path)) not in references["outputs"]["directories"]:
            fail(f"{name} is an output, but travels not with the job")

    values = {}
    for name, path in given.items():
        values["RawParam." + name] = path
        for move in moves:
            before, after = move.split("=", 1)
            if (path + "/").startswith(before + "/"):
                path = after + path[len(before) :]
        values["Param." + name] = path

    done = set()
    for step in template["steps"]:
        for need in step.get("dependencies", []):
            if need["dependsOn"] not in done:
                fail(f"{step['name']} needs {need['dependsOn']}, which is no step before it")
        if step["name"] in done:
            fail(f"there are two steps {step['name']}")
        done.add(step["name"])
        for task in tasks(step):
            with tempfile.TemporaryDirectory() as session:
                here = dict(values, **{"Task.Param." + name: value for name, value in task.items()})
                here.update({"Task.File." + file["name"]: os.path.join(session, file["filename"]) for file in step["script"]["embeddedFiles"]})
                for file in step["script"]["embeddedFiles"]:
                    open(here["Task.File." + file["name"]], "w").write(resolved(file["data"], here))
                action = step["script"]["actions"]["onRun"]
                command = [resolved(word, here) for word in [action["command"], *action["args"]]]
                if verb == "tasks":
                    print(step["name"], command[2])
                elif subprocess.run(command, cwd=session).returncode != 0:
                    fail(f"{step['name']} {task} failed")


main()
