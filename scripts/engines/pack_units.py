"""Packs the units of units.cpp: pack_units.py LIBRARY FOLDER."""
import pathlib
import sys
import zipfile

UNITS = {"suspension": ("CoSimulation", 4, 0.005), "drive": ("CoSimulation", 5, 0.001), "rod": ("ModelExchange", 30, 0.1)}
library, folder = map(pathlib.Path, sys.argv[1:])
for name, (kind, states, step) in UNITS.items():
    variables = "".join(f'<ScalarVariable name="y{i}" valueReference="{i}" initial="exact"><Real start="0"/></ScalarVariable>'
                        for i in range(states))
    rates = "".join(f'<ScalarVariable name="der(y{i})" valueReference="{states + i}"><Real derivative="{i + 1}"/></ScalarVariable>'
                    for i in range(states))
    derivatives = "".join(f'<Unknown index="{states + i + 1}"/>' for i in range(states))
    description = (f'<?xml version="1.0"?><fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{name}">'
                   f'<{kind} modelIdentifier="units"/><DefaultExperiment stepSize="{step}"/>'
                   f"<ModelVariables>{variables}{rates}</ModelVariables>"
                   f"<ModelStructure><Derivatives>{derivatives}</Derivatives></ModelStructure></fmiModelDescription>")
    with zipfile.ZipFile(folder / f"{name}.fmu", "w") as unit:
        unit.writestr("modelDescription.xml", description)
        unit.write(library, "binaries/linux64/units.so")
