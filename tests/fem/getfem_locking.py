#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""References of locking_test.cpp from elements that cannot lock: GetFEM's quadratic displacements with linear pressures.

    getfem_locking.py CELLS

Prints for every Poisson's ratio the compliance (J, the work of the load) of the sheared bar and of the confined cube, each
with CELLS cells along its edges.
"""
import sys

import getfem as gf
import numpy as np

YOUNG = 1e3


def compliance(mesh, poisson, traction, clamped, sliding):
    """`traction` is GWFL text for dead loads on region 1, `clamped` a region, `sliding` pairs of region and axis."""
    mu = YOUNG / (2 * (1 + poisson))
    bulk = YOUNG * poisson / ((1 + poisson) * (1 - 2 * poisson)) + mu  # of the law: lambda + mu; its slope is -mu
    quadratic, linear = gf.MeshFem(mesh, 3), gf.MeshFem(mesh, 1)
    quadratic.set_fem(gf.Fem("FEM_PK(3,2)"))
    linear.set_fem(gf.Fem("FEM_PK(3,1)"))
    points = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(6)"))
    model = gf.Model("real")
    model.add_fem_variable("u", quadratic)
    model.add_fem_variable("p", linear)
    j = "Det(Id(3)+Grad_u)"
    model.add_nonlinear_term(
        points, f"{mu / 2!r}*(Norm_sqr(Id(3)+Grad_u)-3)-{mu!r}*({j}-1)+p*({j}-1)-{0.5 / bulk!r}*sqr(p)")
    model.add_linear_term(points, f"-({traction}).Test_u", 1)
    if clamped:
        model.add_Dirichlet_condition_with_simplification("u", clamped)
    for region, axis in sliding:
        model.add_initialized_data(f"h{region}", np.diag(np.eye(3)[axis]).ravel(), (3, 3))
        model.add_initialized_data(f"r{region}", [0, 0, 0])
        model.add_generalized_Dirichlet_condition_with_multipliers(points, "u", 1, region, f"r{region}", f"h{region}")
    iterations, converged = model.solve("max_res", 1e-7, "max_iter", 40, "lsolver", "mumps")
    if not converged:
        sys.exit(f"getfem_locking.py: no equilibrium in {iterations} iterations")
    return gf.asm_generic(points, 0, f"({traction}).u", 1, model)


def box(cells, length):
    mesh = gf.Mesh("regular simplices", np.linspace(0, length, cells + 1), *2 * [np.linspace(0, 1, cells + 1)])
    faces = mesh.outer_faces()
    return mesh, faces, mesh.normal_of_faces(faces)


def cook(cells, poisson):
    mesh, faces, normals = box(cells, 3)
    mesh.set_region(1, faces[:, normals[0] > 0.9])
    mesh.set_region(2, faces[:, normals[0] < -0.9])
    return compliance(mesh, poisson, "[0;0;1]", 2, [])


def confined(cells, poisson):
    mesh, faces, normals = box(cells, 1)
    mesh.set_region(1, faces[:, normals[2] > 0.9])
    walls = []
    for axis, sign in ((0, -1), (1, -1), (2, -1), (0, 1), (1, 1)):
        region = 2 + len(walls)
        mesh.set_region(region, faces[:, sign * normals[axis] > 0.9])
        walls.append((region, axis))
    load = f"[0;0;{-0.1 * YOUNG!r}*sqr(sin(pi*X(1)))*sqr(sin(pi*X(2)))]"
    return compliance(mesh, poisson, load, None, walls)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    gf.util("trace level", 0)
    for nu in (0.45, 0.49, 0.499, 0.4999):
        print(nu, repr(float(cook(int(sys.argv[1]), nu))), repr(float(confined(int(sys.argv[1]), nu))), flush=True)
