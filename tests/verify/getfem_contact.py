#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigid tip pressed into a hyperelastic block, by GetFEM (python3-getfem 5.4): forces to compare with ours.

    getfem_contact.py PROBLEM

PROBLEM is text, lengths in mm and stresses in kPa (forces: mN), a keyword a line:
    law MU C01 NU      W = MU/2 (F:F - 3) + C01 (|cof F|^2 - 3) + slope (J - 1) + bulk/2 (J - 1)^2
    sphere R | punch A EDGE
    stiffness P [P...] pressure over overlap (kPa/mm), one solve after the other at every depth; the last counts
    depths D [D...]    increasing
    nodes N            then N lines X Y Z
    tets M             then M lines of four nodes each
The tip touches the block's top (z = 0) at the origin; the lower face is held. Plain quadratic tetrahedra, the volume term at
the integration points. Prints "DEPTH FORCE" for each depth; exit status 1 where Newton's method fails.
"""
import sys

import getfem as gf
import numpy as np


def read(file):
    problem, lines = {}, iter(open(file))
    for line in lines:
        key, *values = line.split()
        if key in ("nodes", "tets"):
            rows = [next(lines).split() for _ in range(int(values[0]))]
            problem[key] = np.array(rows, dtype=float if key == "nodes" else int)
        else:
            problem[key] = [float(v) for v in values]
    return problem


def energy(mu, c01, poisson):
    """Slope and bulk follow from W's stress at F = I, which is none, and its bulk modulus at small strain."""
    shear = mu + 2 * c01
    compression = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson))
    slope = -(mu + 4 * c01)
    bulk = compression - (3 * mu + 36 * c01 + 6 * slope) / 9
    f = "(Id(3)+Grad_u)"
    i1, j = f"Norm_sqr({f})", f"Det({f})"
    i2 = f"(0.5*(sqr({i1})-Norm_sqr({f}'*{f})))"
    return f"{mu / 2!r}*({i1}-3)+{c01!r}*({i2}-3)+{slope!r}*({j}-1)+{bulk / 2!r}*sqr({j}-1)"


def gap(problem):
    """Signed distance to the tip of where a point has gone."""
    if "sphere" in problem:
        (radius,) = problem["sphere"]
        return f"(Norm(X+u-[0;0;{radius!r}])-{radius!r})"
    radius, edge = problem["punch"]
    rho = "sqrt(sqr((X+u)(1))+sqr((X+u)(2))+1e-12)"
    return f"(Norm([pos_part({rho}-{radius - edge!r});pos_part({edge!r}-(X+u)(3))])-{edge!r})"


def solve(problem):
    nodes, tets = problem["nodes"], problem["tets"]
    mesh = gf.Mesh("empty", 3)
    mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), nodes[tets].transpose(2, 1, 0))
    faces = mesh.outer_faces()
    normals = mesh.normal_of_faces(faces)
    mesh.set_region(1, faces[:, normals[2] > 0.999])
    mesh.set_region(2, faces[:, normals[2] < -0.999])

    quadratic = gf.MeshFem(mesh, 3)
    quadratic.set_fem(gf.Fem("FEM_PK(3,2)"))
    inside = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(5)"))
    on_top = gf.MeshIm(mesh, gf.Integ("IM_STRUCTURED_COMPOSITE(IM_TETRAHEDRON(6),2)"))
    model = gf.Model("real")
    model.add_fem_variable("u", quadratic)
    model.add_nonlinear_term(inside, energy(*problem["law"]))
    # The tip stays and the block is lifted against it; what holds its lower face is the force.
    model.add_initialized_data("lift", [0, 0, 0])
    model.add_filtered_fem_variable("hold", quadratic, 2)
    model.add_linear_term(inside, "-hold.Test_u-(u-lift).Test_hold", 2)
    model.add_initialized_data("stiffness", [0])
    model.add_nonlinear_term(on_top, f"0.5*stiffness*sqr(neg_part({gap(problem)}))", 1)
    for depth in problem["depths"]:
        model.set_variable("lift", [0, 0, depth])
        for stiffness in problem["stiffness"]:
            model.set_variable("stiffness", [stiffness])
            iterations, converged = model.solve("max_res", 1e-7, "max_iter", 60, "lsolver", "mumps")
            if not converged:
                sys.exit(f"getfem_contact.py: no equilibrium at depth {depth} in {iterations} iterations")
        force = gf.asm_generic(inside, 0, "hold", 2, model)
        print(depth, repr(float(force[2])), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    gf.util("trace level", 0)
    solve(read(sys.argv[1]))
