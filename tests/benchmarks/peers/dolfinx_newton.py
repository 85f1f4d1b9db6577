"""Newton's method for a discrete energy in DOLFINx: what a user has to write round PETSc."""

import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc


class Equilibrium:
    """The force and the stiffness of an energy of u, with fixed values, in the form that PETSc's SNES calls."""

    def __init__(self, energy, u, supports):
        self.u, self.supports = u, supports
        residual = ufl.derivative(energy, u)
        self.L, self.a = fem.form(residual), fem.form(ufl.derivative(residual, u))
        self.b, self.A = fem.petsc.create_vector(self.L), fem.petsc.create_matrix(self.a)
        self.x, self.iterations = u.vector.copy(), 0

    def force(self, snes, x, b):
        x.copy(self.u.vector)
        with b.localForm() as local:
            local.set(0.0)
        fem.petsc.assemble_vector(b, self.L)
        fem.petsc.apply_lifting(b, [self.a], [self.supports], [x], -1.0)
        fem.petsc.set_bc(b, self.supports, x, -1.0)

    def stiffness(self, snes, x, A, P):
        A.zeroEntries()
        fem.petsc.assemble_matrix(A, self.a, self.supports)
        A.assemble()

    def solver(self, most):
        snes = PETSc.SNES().create(MPI.COMM_SELF)
        snes.setFunction(self.force, self.b)
        snes.setJacobian(self.stiffness, self.A)
        snes.setTolerances(rtol=1e-10, atol=1e-9, stol=0.0, max_it=most)
        # full steps: a search by the residual stalls at kinks of the law, and residuals may rise on the way
        PETSc.Options()["snes_linesearch_type"] = "basic"
        PETSc.Options()["snes_divergence_tolerance"] = -1
        snes.setFromOptions()
        snes.getKSP().setType("preonly")
        snes.getKSP().getPC().setType("lu")
        snes.getKSP().getPC().setFactorSolverType("mumps")
        return snes

    def settle(self, snes):
        """Go on from x to equilibrium."""
        snes.solve(None, self.x)
        self.iterations += snes.getIterationNumber()
        if snes.getConvergedReason() <= 0:
            raise ArithmeticError(
                f"SNES reason {snes.getConvergedReason()} after {self.iterations} iterations"
            )
        self.x.copy(self.u.vector)

    def reactions(self):
        """What the supports exert, per node of three or two components."""
        return fem.petsc.assemble_vector(self.L).array.reshape(-1, self.u.function_space.dofmap.bs)
