"""Owners of step limits by MuJoCo alone: owners.py HMAX BISECT_MUJOCO, from the build of scripts/engines/probe.

Writes other stiffness and damping into scenes, and compares the change of their limits with the share that hmax gives the
owner, and their limits at the largest stiffness and damping with the timestep. Ends with 1 where they differ by more than
0.01, or 0.5 %.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
# What stands in a file, and what is written there for factors k of stiffness and c of damping.
SCENES = {
    "robot_arm": ('joint="wrist" kp="200"', lambda k, c: f'joint="wrist" kp="{200 * k}"'),
    "crane": ('kp="5000"', lambda k, c: f'kp="{5000 * k}"'),
    "muscle_leg": ('stiffness="4000" damping="1"', lambda k, c: f'stiffness="{4000 * k}" damping="{c}"'),
    "cable": ('stiffness="0.8" damping="0.002"', lambda k, c: f'stiffness="{0.8 * k}" damping="{0.002 * c}"'),
    "weld": ("-30000 -20", lambda k, c: f"{-30000 * k} {-20 * c}"),
    "steering": ('kv="0.5"', lambda k, c: f'kv="{0.5 * c}"'),
    "servo": ('gainprm="150" biastype="affine" biasprm="0 -150 -4"',
              lambda k, c: f'gainprm="{150 * k}" biastype="affine" biasprm="0 {-150 * k} {-4 * c}"'),
    "tendon_arm": ('stiffness="4000" damping="6"', lambda k, c: f'stiffness="{4000 * k}" damping="{6 * c}"'),
    "implicit": ('stiffness="800" damping="3"', lambda k, c: f'stiffness="{800 * k}" damping="{3 * c}"'),
    "pendulum": ('stiffness="20"', lambda k, c: f'stiffness="{20 * k}"'),
    "loop": ("-20000 -40", lambda k, c: f"{-20000 * k} {-40 * c}"),
}


def output(*command, **options):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, **options).stdout


def main(hmax, bisect):
    agree = True
    print(f"{'scene':12} {'share':>7} {'engine':>7}   limit / timestep at the largest stiffness, damping")
    for scene, (stands, written) in SCENES.items():
        file = HERE / "scenes" / f"{scene}.xml"
        text = file.read_text()
        assert stands in text, scene
        found = json.loads(output(hmax, "probe", file, "--json"))
        owner, h_max, timestep = found["owner"], found["h_max"], found["timestep"]

        def limit(k, c, about):
            with tempfile.TemporaryDirectory() as folder:
                (pathlib.Path(folder) / "scene.xml").write_text(text.replace(stands, written(k, c)))
                return float(output(bisect, "scene.xml", about / 10, 2 * about, cwd=folder).split()[-1])

        s = 1.05
        share = -math.log(limit(s * s, s, h_max) / limit(s ** -2, 1 / s, h_max)) / (2 * math.log(s))
        whole = owner["alike"]["share"]
        ratios = []
        for number in ("stiffness", "damping"):
            largest = owner[number]["largest_of_alike"]
            if not isinstance(largest, float):
                continue
            factor = largest / owner[number]["value"]
            ratios.append((limit(factor, 1, timestep) if number == "stiffness" else limit(1, factor, timestep)) / timestep)
        agree = agree and abs(share - whole) < 0.01 and all(abs(ratio - 1) < 5e-3 for ratio in ratios)
        print(f"{scene:12} {whole:7.4f} {share:7.4f}   {', '.join(f'{ratio:.4f}' for ratio in ratios)}", flush=True)
    return not agree


if __name__ == "__main__":
    sys.exit(main(*map(pathlib.Path, sys.argv[1:])))
