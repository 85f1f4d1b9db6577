"""Plane prestress of the flat sheet: linear, and of finite strain (St. Venant-Kirchhoff).

Displacements are cubic on triangles: compression across a pulled sheet is a hundredth of the tension along it, and its
relative error decides the buckling load (quadratic ones need four times the vertices for the same factors).

Displacements of supported edges are given. The force that holds an edge is the sum of the nodal residuals there, which
is the exact derivative of the discrete energy with respect to the edge's movement, not an integral of edge stresses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array
from skfem import Basis, BilinearForm, ElementQuad2, ElementTriP3, ElementVector, LinearForm, MeshQuad
from skfem.helpers import ddot, eye, grad, mul, sym_grad, trace, transpose

from femref.inertia import NotCertified, factorise
from femref.sheet_mesh import PlateMaterial, SheetMesh

# (reference points (2, k), load) -> displacement (2, k), both in mm
Movement = Callable[[np.ndarray, float], np.ndarray]
_MOST_NEWTON_STEPS = 25
_SMALLEST_STEP = 2.0**-8
_LOST = 1e3  # a nodal force beyond this, per Y h L, is that of a torn sheet


class NoPrestress(ArithmeticError):
    """A plane state that the Newton iteration did not reach; the message is one sentence."""


@dataclass(frozen=True)
class PlaneState:
    """A plane state of the sheet.

    gradient : (2, 2, cells, points) F - 1 at the quadrature points. stress : the same shape, S / Y (2nd Piola; of the
    linear theory: sigma / Y).
    displacement_mm : (vertices, 2). reaction_N : edge -> (fx, fy, moment about the origin in N mm), what the support
    exerts. energy_N_mm : of the whole sheet. residual : largest free nodal force / (Y h L).
    unknowns : the displacement field, to start a next load from.
    """

    gradient: np.ndarray
    stress: np.ndarray
    displacement_mm: np.ndarray
    reaction_N: dict[str, tuple[float, float, float]]
    energy_N_mm: float
    residual: float
    unknowns: np.ndarray


@dataclass(frozen=True)
class PlaneProblem:
    """A sheet with given displacements of some edges.

    movements : edge -> Movement. points : local quadrature points and weights at which stresses are wanted
    (those of the plate, `PlateSpace.points`).
    """

    sheet: SheetMesh
    material: PlateMaterial
    movements: Mapping[str, Movement]
    points: tuple[np.ndarray, np.ndarray]

    @cached_property
    def basis(self) -> Basis:
        """Cubic displacements on triangles, biquadratic ones on rectangles."""
        element = ElementQuad2() if isinstance(self.sheet.mesh, MeshQuad) else ElementTriP3()
        return Basis(self.sheet.mesh, ElementVector(element), quadrature=self.points)

    @cached_property
    def held(self) -> np.ndarray:
        """Unknowns of supported edges."""
        return np.unique(np.concatenate([self._of_edge(edge) for edge in self.movements]))

    def _of_edge(self, edge: str) -> np.ndarray:
        return self.basis.get_dofs(self.sheet.edges[edge]).flatten()

    def given(self, load: float) -> np.ndarray:
        """(unknowns,) displacements of the supported edges at a multiple of the load, zero elsewhere, in units of L."""
        value = np.zeros(self.basis.N)
        length, centre = self.sheet.length_mm, np.array(self.sheet.centre_mm)[:, None]
        for edge, movement in self.movements.items():
            unknowns = self._of_edge(edge)
            position = length * self.basis.doflocs[:, unknowns] + centre
            moved = movement(position, load) / length
            component = np.isin(unknowns, self._components[1]).astype(int)
            value[unknowns] = moved[component, np.arange(len(unknowns))]
        return value

    @cached_property
    def _components(self) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns of the x and of the y displacement."""
        dofs = self.basis.dofs
        parts = [dofs.nodal_dofs, dofs.facet_dofs, dofs.interior_dofs]
        x, y = (np.concatenate([part[k::2].ravel() for part in parts if part.size]) for k in range(2))
        return x, y

    def finish(self, unknowns: np.ndarray, finite: bool, force: np.ndarray) -> PlaneState:
        """The state of a displacement field. force : (unknowns,) nodal residual in units of Y h L."""
        field = self.basis.interpolate(unknowns)
        gradient = np.asarray(field.grad)
        strain = 0.5 * (gradient + transpose(gradient))
        if finite:
            strain = strain + 0.5 * np.einsum("kacq,kbcq->abcq", gradient, gradient)
        stress = _stress(self.material, strain)
        material, length = self.material, self.sheet.length_mm
        stiffness = material.young_MPa * material.thickness_mm
        free = np.setdiff1d(np.arange(self.basis.N), self.held)
        return PlaneState(
            gradient,
            stress,
            length * unknowns[self.basis.dofs.nodal_dofs].T,
            {edge: self._reaction(edge, force, unknowns, finite) for edge in self.movements},
            0.5 * stiffness * length**2 * float((ddot(stress, strain) * self.basis.dx).sum()),
            float(np.abs(force[free]).max(initial=0.0)),
            unknowns,
        )

    def _reaction(
        self, edge: str, force: np.ndarray, unknowns: np.ndarray, finite: bool
    ) -> tuple[float, float, float]:
        """Sum of the nodal forces of an edge, and their moment about the origin at the deformed (linear: reference)
        positions; nodes shared with another edge count half each, so that the sums of all edges are the whole."""
        scale = self.sheet.length_mm * self.material.young_MPa * self.material.thickness_mm
        centre = np.array(self.sheet.centre_mm)
        total = np.zeros(3)
        for k in range(2):
            own = np.intersect1d(self._of_edge(edge), self._components[k])
            shared = sum(np.isin(own, self._of_edge(other)).astype(float) for other in self.movements)
            part = scale * force[own] / shared
            other_axis = 1 - k
            twin = self._twin(own, k)
            place = self.basis.doflocs[other_axis, own] + (unknowns[twin] if finite else 0.0)
            arm = self.sheet.length_mm * place + centre[other_axis]
            total[k] = part.sum()
            total[2] += (part * arm).sum() * (-1.0 if k == 0 else 1.0)
        return float(total[0]), float(total[1]), float(total[2])

    def _twin(self, unknowns: np.ndarray, component: int) -> np.ndarray:
        """The unknowns of the other component at the same places."""
        mine, others = self._components[component], self._components[1 - component]
        order = np.argsort(mine)
        return others[order[np.searchsorted(mine[order], unknowns)]]


def linear_state(problem: PlaneProblem, load: float = 1.0) -> PlaneState:
    """Plane stress of linear elasticity at `load` times the given displacements."""
    material, basis = problem.material, problem.basis

    @BilinearForm
    def form(u, v, _):  # type: ignore[no-untyped-def]
        return ddot(_stress(material, sym_grad(u)), sym_grad(v))

    matrix = csc_array(form.assemble(basis))
    unknowns = problem.given(load)
    free = np.setdiff1d(np.arange(basis.N), problem.held)
    unknowns[free] = factorise(matrix[free][:, free]).solve(-(matrix[free] @ unknowns))
    return problem.finish(unknowns, finite=False, force=matrix @ unknowns)


def finite_state(
    problem: PlaneProblem, load: float = 1.0, start: np.ndarray | None = None, tolerance: float = 1e-12
) -> PlaneState:
    """Plane equilibrium of St. Venant-Kirchhoff's membrane energy, of finite strain, by Newton's method.

    start : unknowns of a nearby state (`PlaneState.unknowns`); None is the undeformed sheet. Where the iteration fails,
    the edges move in smaller steps.

    Raises NoPrestress.
    """
    unknowns = np.zeros(problem.basis.N) if start is None else start
    held, wanted = problem.held, problem.given(load)
    part, done = 1.0, 0.0
    while part >= _SMALLEST_STEP:
        target = unknowns[held] + min(1.0, part / (1.0 - done)) * (wanted[held] - unknowns[held])
        reached = _newton(problem, target, unknowns, tolerance)
        if reached is None:
            part /= 2.0
            continue
        unknowns, force = reached
        done += part
        if done >= 1.0 - 1e-12:
            return problem.finish(unknowns, finite=True, force=force)
    raise NoPrestress(
        f"The plane state at {load:g} times the load was not reached; Newton stopped after {done:.3g} of the way."
    )


def _newton(
    problem: PlaneProblem, target: np.ndarray, start: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Unknowns and nodal forces of the equilibrium with `target` at the held edges; None where Newton's method fails.

    The first step carries the edges' movement into the sheet by the tangent: moving the edges alone would crush the
    cells beside them.
    """
    basis, held = problem.basis, problem.held
    free = np.setdiff1d(np.arange(basis.N), held)
    unknowns = start.copy()
    before = np.inf
    for step in range(_MOST_NEWTON_STEPS):
        force, tangent = _force_and_tangent(problem, unknowns)
        size = float(np.abs(force[free]).max(initial=0.0))
        moving = target - unknowns[held]
        # after convergence rounding keeps the residual from falling: that is as good as the tolerance
        if step > 0 and (size <= tolerance or (size < 1e3 * tolerance and size > 0.25 * before)):
            return unknowns, force
        if not np.isfinite(size) or size > _LOST:
            return None
        if step > 0:  # the start's forces belong to edges that have not moved yet
            before = size
        right = force[free] + tangent[free][:, held] @ moving
        try:
            unknowns[free] -= factorise(tangent[free][:, free]).solve(right)
        except NotCertified:
            return None
        unknowns[held] = target
    return None


def _force_and_tangent(problem: PlaneProblem, unknowns: np.ndarray) -> tuple[np.ndarray, csc_array]:
    material, basis = problem.material, problem.basis

    @LinearForm
    def force(v, data):  # type: ignore[no-untyped-def]
        deformation, stress = _finite(material, data["u"])
        return ddot(mul(deformation, stress), grad(v))

    @BilinearForm
    def tangent(u, v, data):  # type: ignore[no-untyped-def]
        deformation, stress = data["F"], data["S"]
        change = mul(transpose(deformation), grad(u))
        virtual = mul(transpose(deformation), grad(v))
        return ddot(mul(grad(u), stress), grad(v)) + ddot(
            _stress(material, 0.5 * (change + transpose(change))), virtual
        )

    field = basis.interpolate(unknowns)
    deformation, stress = _finite(material, field)
    return force.assemble(basis, u=field), csc_array(tangent.assemble(basis, F=deformation, S=stress))


def _finite(material: PlateMaterial, field: object) -> tuple[np.ndarray, np.ndarray]:
    """F and S / Y of a displacement field."""
    gradient = np.asarray(grad(field))
    deformation = gradient + eye(1.0 + 0.0 * gradient[0, 0], 2)
    strain = 0.5 * (mul(transpose(deformation), deformation) - eye(1.0 + 0.0 * gradient[0, 0], 2))
    return deformation, _stress(material, strain)


def _stress(material: PlateMaterial, strain: np.ndarray) -> np.ndarray:
    """S / Y = c tr(E) 1 + 2 mu E."""
    return eye(material.c * trace(strain), 2) + material.two_mu * strain
