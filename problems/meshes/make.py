#!/usr/bin/python3
"""Makes phantom.msh and liver.msh, from seeds: the same bytes each time.

    python3 problems/meshes/make.py            both files, into the folder of this script
    python3 problems/meshes/make.py --to DIR   elsewhere, to compare

Needs the Debian packages python3-numpy, python3-scipy and tetgen; takes about two minutes. README.md says what the
meshes are and what they reach.
"""

import argparse
import pathlib

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

import improve
import phantom_shape
import surface
from liver_shape import Liver
from tetrahedra import Mesh, volumes

PHANTOM_SIDE = 0.1             # m
LIVER_VOLUME = 1.5 / 1060      # m^3: 1.5 kg at 1060 kg / m^3
WANTED = {"phantom": (57, 120, 230, 56, 108), "liver": (299, 1151, 1634, 187, 370)}


def phantom(seed=1):
    rng = np.random.default_rng(seed)
    points, free = phantom_shape.grid(1.0, 3)
    mesh = improve.tetgen(points, phantom_shape.triangles(points, 1.0, rng), np.array([[0.5, 0.5, 0.5]]))
    slide = phantom_shape.Slide(mesh, free)
    smoother = improve.Smoother(mesh, 1 / 3, slide.carry, slide.settle, skin_weight=0.3)
    improve.improve(mesh, smoother, WANTED["phantom"][1], rng, rounds=200, heat=5.0)
    mesh.points[:, :2] -= 0.5  # it stands on z = 0, in the middle
    mesh.points *= PHANTOM_SIDE
    return mesh


def liver(seed=0, margin=30, upper=101):
    rng = np.random.default_rng(seed)
    shape = Liver()
    count, surface_count = WANTED["liver"][0], WANTED["liver"][3]
    disc, sheet = surface.start(shape, surface_count, margin, upper)
    disc, triangles = surface.even(shape, disc, sheet, rounds=300)
    places = shape.points(disc, sheet)
    p = places[triangles]
    area = 0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    size = np.sqrt(area.mean() * 4 / np.sqrt(3))
    inner = improve.inner_points(places, triangles, count - surface_count, 0.45 * size, rng)
    mesh = improve.tetgen(places, triangles, inner)
    skin = surface.Skin(shape, disc, sheet)
    smoother = improve.Smoother(mesh, size, skin.carry, skin.settle)
    improve.improve(mesh, smoother, WANTED["liver"][1], rng, rounds=180, heat=5.0, log=20)
    mesh.points -= 0.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0))
    mesh.points *= np.cbrt(LIVER_VOLUME / volumes(mesh.corners()).sum())
    return mesh


def renumbered(mesh):
    """The same mesh with neighbours near each other in memory (reverse Cuthill-McKee), tetrahedra by corners."""
    edges = np.array(sorted(mesh.edges()))
    n = len(mesh.points)
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(n, n)).tocsr()
    order = np.asarray(reverse_cuthill_mckee((graph + graph.T).tocsr(), symmetric_mode=True))
    rank = np.empty(n, int)
    rank[order] = np.arange(n)
    rows = []
    for tet in mesh.tets:
        tet = [int(rank[i]) for i in tet]
        while tet[0] != min(tet):  # even permutations keep the orientation: smallest first ...
            tet = [tet[1], tet[2], tet[0], tet[3]] if min(tet) != tet[3] else [tet[3], tet[2], tet[1], tet[0]]
        while tet[1] != min(tet[1:]):  # ... then the smallest of the others
            tet = [tet[0], tet[2], tet[3], tet[1]]
        rows.append(tuple(tet))
    return Mesh(mesh.points[order], sorted(rows))


def check(mesh, name):
    """Raises unless the counts are those wanted and the mesh is one valid body."""
    counts = mesh.counts()
    if counts != WANTED[name]:
        raise SystemExit(f"{name}: points, tetrahedra, edges, surface points, triangles are {counts}, "
                         f"wanted {WANTED[name]}")
    if volumes(mesh.corners()).min() <= 0:
        raise SystemExit(f"{name}: a tetrahedron is inverted")
    if max(len(t) for t in mesh.faces().values()) > 2:
        raise SystemExit(f"{name}: a face has more than two tetrahedra")
    if {i for tet in mesh.tets for i in tet} != set(range(len(mesh.points))):
        raise SystemExit(f"{name}: a point is in no tetrahedron")
    around = {}
    for a, b, c in mesh.surface():
        for i, j in ((a, b), (b, c), (c, a)):
            around.setdefault((i, j), 0)
            around[i, j] += 1
    if any(k != 1 or (j, i) not in around for (i, j), k in around.items()):
        raise SystemExit(f"{name}: the surface is not a closed manifold")


def write_msh(path, mesh, name):
    """Gmsh 2.2, ASCII, metres; one physical region, no surface elements."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "1", f'3 1 "{name}"', "$EndPhysicalNames",
             "$Nodes", str(len(mesh.points))]
    lines += [f"{i} {x:.9f} {y:.9f} {z:.9f}" for i, (x, y, z) in enumerate(mesh.points + 0.0, 1)]
    lines += ["$EndNodes", "$Elements", str(len(mesh.tets))]
    lines += [f"{i} 4 2 1 1 {a + 1} {b + 1} {c + 1} {d + 1}" for i, (a, b, c, d) in enumerate(mesh.tets, 1)]
    lines += ["$EndElements", ""]
    path.write_text("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent)
    folder = parser.parse_args().to
    for name, build in (("phantom", phantom), ("liver", liver)):
        mesh = renumbered(build())
        mesh.points = np.round(mesh.points, 9)
        check(mesh, name)
        write_msh(folder / f"{name}.msh", mesh, name)
        smallest, largest = improve.quality(mesh)
        edges = np.array(sorted(mesh.edges()))
        length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
        extent = 1000 * (mesh.points.max(axis=0) - mesh.points.min(axis=0))
        each = volumes(mesh.corners())
        print(f"{name}: points, tetrahedra, edges, surface points, triangles {mesh.counts()}\n"
              f"  dihedral angles {smallest:.2f} to {largest:.2f} degrees, edges {1000 * length.min():.1f} to "
              f"{1000 * length.max():.1f} mm\n"
              f"  volume {1e6 * each.sum():.2f} cm^3, of a tetrahedron {1e6 * each.min():.3f} to "
              f"{1e6 * each.max():.3f}, extent {extent[0]:.1f} x {extent[1]:.1f} x {extent[2]:.1f} mm")


if __name__ == "__main__":
    main()
