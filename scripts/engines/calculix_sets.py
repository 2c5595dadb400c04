"""Sets of matrices of CalculiX: decks of its own examples (Debian package calculix-ccx-test), and a body in C3D4."""
import gzip
import os
import pathlib
import re
import subprocess

import matrix_set

EXAMPLES = pathlib.Path("/usr/share/doc/calculix-ccx-test/examples/test")


def deck_of(name):
    """The text of an example up to the first *FREQUENCY of it, and what follows."""
    files = [EXAMPLES / (name + ".inp"), EXAMPLES / (name + ".inp.gz")]
    file = next(file for file in files if file.exists())
    text = (gzip.open if file.suffix == ".gz" else open)(file, "rt", errors="replace").read()
    return re.split(r"(?im)^\*FREQUENCY.*\n.*\n", text, maxsplit=1)[0]


def run(folder, job, deck):
    (folder / f"{job}.inp").write_text(deck)
    done = subprocess.run(["ccx", job], cwd=folder, capture_output=True, text=True, timeout=600,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    if "*ERROR" in done.stdout:
        raise SystemExit(f"{folder}/{job}: " + re.search(r"\*ERROR.*\n.*", done.stdout).group())
    return done.stdout


def stored(folder, model):
    """Writes job.sti, job.mas and job.dof; the number of unknowns."""
    run(folder, "job", model + "*FREQUENCY, SOLVER=MATRIXSTORAGE\n10\n*END STEP\n")
    return len((folder / "job.dof").read_text().split())


def lowest(folder, model, unknowns):
    """The lowest frequencies [rad/s] that CalculiX prints for the model, at most ten, and a fifth of all, as it asks for."""
    run(folder, "modes", model + f"*FREQUENCY\n{min(10, max(unknowns // 5, 1))}\n*END STEP\n")
    text = (folder / "modes.dat").read_text().split("E I G E N V A L U E")[1].split("P A R T")[0]
    return [float(row.split()[2]) or -abs(float(row.split()[4]))
            for row in text.splitlines() if re.match(r"\s*\d+\s+\S+\s+\S+\s+\S+\s+\S+$", row)]


def stable_increment(folder, head):
    """The time increment [s] that CalculiX selects for its explicit dynamics, with lumped masses."""
    text = run(folder, "explicit", head + "*STEP, NLGEOM, INC=1000000\n*DYNAMIC, EXPLICIT\n1e-30, 1e-29\n*END STEP\n")
    return float(re.search(r"initial stable time increment:\s*(\S+)", text).group(1))


def example(name, element, explicit=False, modes=True, refused=""):
    def make(folder, _):
        model = deck_of(name)
        unknowns = stored(folder, model)
        own = []
        if modes:
            own.append({"what": "*FREQUENCY", "method": "lowest", "value": lowest(folder, model, unknowns), "unit": "rad/s"})
        if explicit:
            head = re.split(r"(?im)^\*STEP", model)[0]
            own.append({"what": "*DYNAMIC, EXPLICIT", "method": "symplectic_euler",
                        "value": stable_increment(folder, head), "unit": "s"})
        mass = {"mass": ("lumped:" if explicit else "") + "job.mas"}
        matrix_set.save(folder, program="CalculiX", element=element, unknowns=unknowns,
                        mass="row sums" if explicit else "consistent", matrices={"stiffness": "job.sti"} | mass, own=own,
                        refused=refused)
    return make


def body(explicit):
    """A free body of soft tissue in linear tetrahedra, in m, N and kg."""
    def make(folder, mesh):
        points, cells = matrix_set.tetrahedra(mesh)
        head = "*NODE, NSET=N\n"
        head += "".join(f"{i + 1}, {x:.12e}, {y:.12e}, {z:.12e}\n" for i, (x, y, z) in enumerate(points))
        head += "*ELEMENT, TYPE=C3D4, ELSET=E\n"
        head += "".join(f"{k + 1}, " + ", ".join(str(i + 1) for i in cell) + "\n" for k, cell in enumerate(cells))
        head += "*MATERIAL, NAME=TISSUE\n*ELASTIC\n5500., 0.45\n*DENSITY\n1060.\n*SOLID SECTION, ELSET=E, MATERIAL=TISSUE\n"
        unknowns = stored(folder, head + "*STEP\n")
        own = [{"what": "*FREQUENCY", "method": "lowest", "value": lowest(folder, head + "*STEP\n", unknowns), "unit": "rad/s"}]
        if explicit:
            own = [{"what": "*DYNAMIC, EXPLICIT", "method": "symplectic_euler", "value": stable_increment(folder, head),
                    "unit": "s"}]
        matrix_set.save(folder, program="CalculiX", element="C3D4, free body", unknowns=unknowns,
                        mass="row sums" if explicit else "consistent",
                        matrices={"stiffness": "job.sti", "mass": ("lumped:" if explicit else "") + "job.mas"}, own=own)
    return make


SINGULAR = "not positive definite"  # eight integration points give the 60 unknowns of an element the rank 24

SETS = {
    "ccx_beam_c3d8": example("beam8f", "C3D8"),
    "ccx_beam_c3d8_lumped": example("beam8f", "C3D8", explicit=True, modes=False),
    "ccx_beam_c3d20r": example("beamf", "C3D20R", refused=SINGULAR),
    "ccx_beam_buckling": example("beamf2", "C3D20R near buckling", refused=SINGULAR),
    "ccx_shell_s8": example("shellf", "S8 with MPCs"),
    "ccx_profile_b32r": example("uprofile", "B32R", refused=SINGULAR),
    "ccx_rigid_body": example("damper1", "C3D20 with a rigid body"),
    "ccx_springs_cpe8": example("spring4", "CPE8 and springs"),
    "ccx_segment_c3d10": example("segmenttet", "C3D10 with ties", modes=False),
    "ccx_body_c3d4": body(False),
    "ccx_body_c3d4_lumped": body(True),
}

if __name__ == "__main__":
    matrix_set.make(SETS)
