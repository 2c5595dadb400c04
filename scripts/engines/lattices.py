"""Writes the scenes whose bodies are points of a lattice: lattices.py FOLDER makes net.xml and cloth.xml of MuJoCo, and gel.vtk,
arch.vtk and pad.vtk of Bullet there."""
import math
import pathlib
import sys

SIDE, APART = 8, 0.05  # points along an edge, and their distance [m]
TENDON, DIAGONAL = (f'stiffness="{stiffness}" damping="0.02"' for stiffness in (80, 30))


def scene(words, place, held, damping, steps):
    """Points (i, j) at place(i, j) that slide with this damping where they are not held.

    steps   [(attributes, (rows, columns))]: the tendons from each point, but for those between two that are held
    """
    points = [(i, j) for i in range(SIDE) for j in range(SIDE)]
    links = [(tendon, (i, j), (i + down, j + across)) for i, j in points for tendon, (down, across) in steps
             if (i + down, j + across) in points and not (held(i, j) and held(i + down, j + across))]
    slides = "".join(f'<joint type="slide" axis="{axis}" damping="{damping}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    ball = '<geom type="sphere" size="0.005" mass="0.005" contype="0" conaffinity="0"/>'
    lines = ["<mujoco>", f"  <!-- {words} Euler. -->", '  <option timestep="0.001" integrator="Euler"/>', "  <worldbody>"]
    for i, j in sorted({point for _, *ends in links for point in ends}):
        lines.append(f'    <site name="p{i}_{j}" pos="{place(i, j)}"/>' if held(i, j) else
                     f'    <body pos="{place(i, j)}">{slides}{ball}<site name="p{i}_{j}"/></body>')
    lines += ["  </worldbody>", "  <tendon>"]
    lines += [f'    <spatial {tendon}><site site="p{i}_{j}"/><site site="p{k}_{l}"/></spatial>' for tendon, (i, j), (k, l) in links]
    return "\n".join([*lines, "  </tendon>", "</mujoco>", ""])


SCENES = {
    "net": scene("A net of 8 x 8 points, held at its edges, which sags a little; its links are elastic tendons with dampers.",
                 lambda i, j: f"{APART * j:.2f} {APART * i:.2f} 0", lambda i, j: {i, j} & {0, SIDE - 1}, 0.02,
                 [(TENDON + ' springlength="0.04"', step) for step in ((1, 0), (0, 1))]),
    "cloth": scene("A cloth of 8 x 8 points of 5 g, which hangs from its first row; elastic tendons with dampers hold it.",
                   lambda i, j: f"{APART * j:.2f} 0 {0 - APART * i:.2f}", lambda i, j: i == 0, 0.01,
                   [(DIAGONAL, (1, -1)), (TENDON, (1, 0)), (TENDON, (0, 1)), (DIAGONAL, (1, 1))]),
}

# Six tetrahedra of a cube around its diagonal, by the corners (x, y, z) that a path along its edges visits.
PATHS = [((1, 0, 0), (1, 1, 0)), ((0, 1, 0), (1, 1, 0)), ((0, 1, 0), (0, 1, 1)), ((0, 0, 1), (0, 1, 1)), ((0, 0, 1), (1, 0, 1)),
         ((1, 0, 0), (1, 0, 1))]


def body(cells, place):
    """A block of cubes in tetrahedra, whose points are at place(i, j, k); VTK."""
    counts = [cell + 1 for cell in cells]
    number = {point: n for n, point in enumerate((i, j, k) for i in range(counts[0]) for j in range(counts[1])
                                                 for k in range(counts[2]))}
    tetrahedra = []
    for i in range(cells[0]):
        for j in range(cells[1]):
            for k in range(cells[2]):
                for n, path in enumerate(PATHS):
                    corners = [number[i + a, j + b, k + c] for a, b, c in ((0, 0, 0), *path, (1, 1, 1))]
                    tetrahedra.append(corners if n % 2 == 0 else [corners[0], corners[2], corners[1], corners[3]])
    lines = ["# vtk DataFile Version 2.0", "body", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(number)} double"]
    lines += [" ".join(f"{x:.9g}" for x in place(*point)) for point in number]
    lines += [f"CELLS {len(tetrahedra)} {5 * len(tetrahedra)}", *("4 " + " ".join(map(str, each)) for each in tetrahedra)]
    return "\n".join([*lines, f"CELL_TYPES {len(tetrahedra)}", *["10"] * len(tetrahedra), ""])


def arch(i, j, k):
    """Half a ring that stands on z = 0."""
    angle, radius = math.pi * i / 16, 0.05 + 0.01 * k
    return -radius * math.cos(angle), 0.012 * j, radius * math.sin(angle)


folder = pathlib.Path(sys.argv[1])
(folder / "gel.vtk").write_text(body((3, 2, 2), lambda i, j, k: (0.02 * i, 0.015 * j + 0.002 * i, 0.01 * k)))
(folder / "arch.vtk").write_text(body((16, 3, 2), arch))
(folder / "pad.vtk").write_text(body((4, 3, 2), lambda i, j, k: (0.012 * i + 0.001 * k, 0.011 * j, 0.009 * k + 0.0008 * k * (i - 2) ** 2)))
for name, text in SCENES.items():
    (folder / f"{name}.xml").write_text(text)
