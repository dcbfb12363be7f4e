#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigid tip pressed into a hyperelastic body, by GetFEM (python3-getfem 5.4): forces to compare with ours.

    getfem_contact.py PROBLEM

PROBLEM is text, lengths in mm and stresses in kPa (forces: mN), a keyword a line:
    energy REGION W    in GetFEM's language, of {f} the deformation's gradient F, {i1} and {i2} the invariants of F'F, {j} det F,
                       and positive[X] the positive part
    sphere R | punch A EDGE
    stiffness P [P...] pressure over overlap (kPa/mm), one solve after the other at every depth; the last counts
    depths D [D...]    increasing
    nodes N            then N lines X Y Z
    tets M             then M lines of four nodes and a region each
    held K             then K lines X Y Z of nodes and middles of edges that are held
The tip touches the body at the origin and is pushed along -z. Plain quadratic tetrahedra, the volume term at the integration
points. Prints "DEPTH FORCE" for each depth; exit status 1 where Newton's method fails.
"""
import re
import sys

import getfem as gf
import numpy as np

STEPS = 4  # from one depth to the next


def read(file):
    problem, lines = {}, iter(open(file))
    for line in lines:
        key, *values = line.split()
        if key in ("nodes", "tets", "held"):
            rows = [next(lines).split() for _ in range(int(values[0]))]
            problem[key] = np.array(rows, dtype=int if key == "tets" else float)
        elif key == "energy":
            problem.setdefault(key, []).append((int(values[0]), values[1]))
        else:
            problem[key] = [float(v) for v in values]
    return problem


def energy(template):
    """The terms of a problem's energy in GetFEM's variables."""
    f = "(Id(3)+Grad_u)"
    i1, j = f"Norm_sqr({f})", f"Det({f})"
    i2 = f"(0.5*(sqr({i1})-Norm_sqr({f}'*{f})))"
    template = re.sub(r"positive\[(.*?)\]", lambda part: positive(f"({part[1]})"), template)
    return template.format(f=f, i1=i1, i2=i2, j=j)


def positive(x):
    """The positive part, rounded so that it has two derivatives."""
    return f"(0.5*({x}+sqrt(sqr({x})+1e-12)))"


def gap(problem):
    """Signed distance to the tip of where a point has gone."""
    if "sphere" in problem:
        (radius,) = problem["sphere"]
        return f"(Norm(X+u-[0;0;{radius!r}])-{radius!r})"
    radius, edge = problem["punch"]
    rho = "sqrt(sqr((X+u)(1))+sqr((X+u)(2))+1e-12)"
    return f"(Norm([{positive(f'{rho}-{radius - edge!r}')};{positive(f'{edge!r}-(X+u)(3)')}])-{edge!r})"


def held_unknowns(elements, points):
    """Numbers of the displacements x, y, z of each point."""
    places = {tuple(np.round(x, 6)): n for n, x in enumerate(elements.basic_dof_nodes().T[::3])}
    return np.array([[3 * places[tuple(np.round(x, 6))] + k for k in range(3)] for x in points]).ravel()


def solve(problem):
    nodes, tets, regions = problem["nodes"], problem["tets"][:, :4], problem["tets"][:, 4]
    mesh = gf.Mesh("empty", 3)
    mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), nodes[tets].transpose(2, 1, 0))
    mesh.set_region(1, mesh.outer_faces())
    for region, _ in problem["energy"]:
        members = np.flatnonzero(regions == region)
        mesh.set_region(10 + region, np.array([members, np.full_like(members, -1)]))  # -1: no face, the whole

    quadratic = gf.MeshFem(mesh, 3)
    quadratic.set_fem(gf.Fem("FEM_PK(3,2)"))
    inside = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(5)"))
    on_top = gf.MeshIm(mesh, gf.Integ("IM_STRUCTURED_COMPOSITE(IM_TETRAHEDRON(6),2)"))
    model = gf.Model("real")
    model.add_fem_variable("u", quadratic)
    for region, template in problem["energy"]:
        model.add_nonlinear_term(inside, energy(template), 10 + region)
    # The tip stays and the body is lifted against it; what holds it is the force.
    held = held_unknowns(quadratic, problem["held"])
    pick = gf.Spmat("empty", len(held), quadratic.nbdof())
    for row, unknown in enumerate(held):
        pick.add(row, int(unknown), 1.0)
    upward = np.arange(len(held)) % 3 == 2
    model.add_variable("hold", len(held))
    hold = model.add_constraint_with_multipliers("u", "hold", pick, np.zeros(len(held)))
    model.add_initialized_data("stiffness", [0])
    model.add_nonlinear_term(on_top, f"0.5*stiffness*sqr(neg_part({gap(problem)}))", 1)
    before = 0.0
    for depth in problem["depths"]:
        # Steps with the softest contact lead to it.
        steps = [(before + k / STEPS * (depth - before), problem["stiffness"][0]) for k in range(1, STEPS)]
        before = depth
        for lift, stiffness in steps + [(depth, stiffness) for stiffness in problem["stiffness"]]:
            model.set_private_rhs(hold, lift * upward)
            model.set_variable("stiffness", [stiffness])
            iterations, converged = model.solve("max_res", 1e-7, "max_iter", 60, "lsolver", "mumps")
            if not converged:
                sys.exit(f"getfem_contact.py: no equilibrium at depth {lift} in {iterations} iterations")
        print(depth, repr(float(-model.variable("hold")[upward].sum())), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    gf.util("trace level", 0)
    solve(read(sys.argv[1]))
