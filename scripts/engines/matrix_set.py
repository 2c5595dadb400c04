"""What the programs of scripts/against-engines share: a set of matrices, and the limit of their own steps.

A set is a folder with matrix files and `set.json`:

    program, element, mass    words for the table
    unknowns                  rows of the matrices
    matrices                  {"stiffness": FILE, "mass": FILE, ...} as --matrices takes them; files of the folder
    words                     further words of --matrices, such as "storage=triangle"
    options                   further options of hmax, such as ["--beta", "1e-4"]
    own                       [{"what", "method", "value", "unit"}]: what the program says itself. Methods are those of
                              hmax, for limits [s], or "lowest" for the lowest frequencies [rad/s] in rising order
    refused                   words of the error where hmax is to refuse the set; none by default
"""
import json
import pathlib
import sys

import numpy


def save(folder, **facts):
    """Writes set.json of the folder."""
    facts = {"words": [], "options": [], "own": [], "refused": ""} | facts
    (pathlib.Path(folder) / "set.json").write_text(json.dumps(facts, indent=1) + "\n")


def make(sets):
    """Makes the sets that the command line names: PROGRAM_sets.py FOLDER MESH NAME...; without names it lists them."""
    if len(sys.argv) < 3:
        print("\n".join(sets))
        return
    root, mesh = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    for name in sys.argv[3:]:
        folder = root / name
        folder.mkdir(parents=True, exist_ok=True)
        sets[name](folder, mesh)


def tetrahedra(mesh):
    """Points, shape (n, 3), and tetrahedra, shape (m, 4), from 0, of a file in Gmsh 2.2."""
    lines = mesh.read_text().splitlines()
    def rows(section):
        begin = lines.index(section)
        return [line.split() for line in lines[begin + 2:begin + 2 + int(lines[begin + 1])]]
    nodes = rows("$Nodes")
    place = {row[0]: i for i, row in enumerate(nodes)}
    cells = [[place[node] for node in row[-4:]] for row in rows("$Elements") if row[1] == "4"]
    return numpy.array([[float(x) for x in row[1:]] for row in nodes]), numpy.array(cells)


def largest_step(grows, guess):
    """The step size at which steps of a program begin to grow, to 1e-6 of itself, from a guess within 20 %.

    grows(h): whether the program's own steps of that size grow.
    """
    low, high = 0.8 * guess, 1.2 * guess
    if grows(low) or not grows(high):
        raise SystemExit(f"steps of the program have no limit between {low:g} and {high:g} s")
    while high - low > 1e-6 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return (low + high) / 2


def symplectic_euler_grows(force, mass, steps=4000, seed=1):
    """grows(h) for steps v += h force(q, v) / mass, q += h v from a random start.

    force   of the program, from q and v, shape (n); mass   lumped, shape (n)
    """
    def grows(h):
        random = numpy.random.default_rng(seed)
        q = 1e-3 * random.standard_normal(mass.size)
        v = numpy.zeros(mass.size)
        start = numpy.linalg.norm(q)
        for step in range(steps):
            v += h * force(q, v) / mass
            q += h * v
            if step % 100 == 99 and not numpy.linalg.norm(q) < 1e6 * start:
                return True
        return False
    return grows
