"""Writes the scenes of MuJoCo whose bodies are points of a lattice: lattices.py FOLDER makes net.xml and cloth.xml there."""
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

for name, text in SCENES.items():
    (pathlib.Path(sys.argv[1]) / f"{name}.xml").write_text(text)
