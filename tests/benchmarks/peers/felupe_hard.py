"""FElupe on a hard case: the same sheet, nodes, supports and start, by Newton's method; no result is hidden.

Needs numpy, scipy and FElupe alone. Called with the files of the question and of the answer (`hard_question.Question`
writes the one and reads the other). A plate is a solid, one layer of triquadratic hexahedra; a
membrane has biquadratic elements. What the start does not lead to in one step is tried once more in ten load steps.
"""

import json
import resource
import sys
import time

import felupe as fem
import numpy as np
from scipy.sparse.linalg import splu

SECONDS = 100  # of CPU; then the system ends the process
ITERATIONS, TOLERANCE, LOAD_STEPS = 40, 1e-9, 10
LARGEST_POISSON = 0.499  # of a solid: at 0.5 its bulk modulus is infinite
SOFTNESS = tuple(
    10.0**-k for k in range(1, 6)
)  # of the unrelaxed energy, left to what is slack; lowered in steps


def factorised(matrix, right):
    """Solve a symmetric system; SuperLU's ordering for such is four times as fast as its default here."""
    symmetric = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=symmetric).solve(
        right
    )


class Solid:
    """St. Venant and Kirchhoff's law in space."""

    softness = (1.0,)

    def __init__(self, young, poisson):
        nu = min(poisson, LARGEST_POISSON)
        mu, lame = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
        one = np.eye(3)
        self.modulus = lame * np.einsum("ij,kl->ijkl", one, one)
        self.modulus += mu * (np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one))

    def second(self, F):
        """Second Piola stress, its derivative by the strain, and the energy density."""
        E = 0.5 * (np.einsum("ki...,kj...->ij...", F, F) - np.eye(3)[(...,) + (None,) * (F.ndim - 2)])
        S = np.einsum("ijkl,kl...->ij...", self.modulus, E)
        shape = (3, 3, 3, 3, *F.shape[2:])
        D = np.broadcast_to(self.modulus[(...,) + (None,) * (F.ndim - 2)], shape)
        return S, D, 0.5 * np.einsum("ij...,ij...->...", S, E)


class Membrane:
    """The relaxed membrane (Pipkin 1986); with the softness 1 the unrelaxed one."""

    def __init__(self, young, poisson, relaxed):
        self.young, self.poisson, self.soft = young, poisson, 1.0
        self.softness = SOFTNESS if relaxed else (1.0,)

    def second(self, F):
        """As that of `Solid`, on the principal directions of the strain."""
        C, nu = np.einsum("ki...,kj...->ij...", F, F), self.poisson
        mean, half, e12 = 0.25 * (C[0, 0] + C[1, 1]) - 0.5, 0.25 * (C[0, 0] - C[1, 1]), 0.5 * C[0, 1]
        radius, angle = np.sqrt(half**2 + e12**2 + 1e-20), 0.5 * np.arctan2(e12, half)
        major, minor = mean + radius, mean - radius
        on = np.where(minor + nu * major > 0, 1.0, self.soft) / (1 - nu**2)
        d11, d12, d22 = np.where(major > 0, 1.0, self.soft) + nu**2 * on, nu * on, on
        s1, s2 = d11 * major + d12 * minor, d12 * major + d22 * minor
        m = np.array([np.cos(angle), np.sin(angle)])
        n = np.array([-m[1], m[0]])
        first, second, mixed = (np.einsum("i...,j...->ij...", a, b) for a, b in ((m, m), (n, n), (m, n)))
        shear = mixed + mixed.swapaxes(0, 1)
        D = 0.0
        for d, a, b in (
            (d11, first, first),
            (d22, second, second),
            (d12, first, second),
            (d12, second, first),
            (0.25 * (s1 - s2) / radius, shear, shear),
        ):
            D = D + d * np.einsum("ij...,kl...->ijkl...", a, b)
        energy = 0.5 * (s1 * major + s2 * minor)
        return self.young * (s1 * first + s2 * second), self.young * D, self.young * energy


def material(law):
    """The law as FElupe takes it: first Piola stress and its derivative by the gradient."""

    def stress(x):
        return [np.einsum("ik...,kj...->ij...", x[0], law.second(x[0])[0]), x[-1]]

    def elasticity(x):
        F = x[0]
        S, D, _ = law.second(F)
        A = np.einsum("im...,mjnl...,kn...->ijkl...", F, D, F)
        return [A + np.einsum("ik,jl...->ijkl...", np.eye(len(F)), S)]

    return fem.Material(stress, elasticity)


def doubled(field, axis, closed):
    """The field with an even number of intervals along an axis: a middle is put into the last one if need be."""
    intervals = field.shape[axis] - (0 if closed else 1)
    if intervals % 2 == 0:
        return field
    last = np.take(field, [0 if closed else -1], axis)
    before = np.take(field, [-1 if closed else -2], axis)
    middle = before & last if field.dtype == bool else 0.5 * (before + last)
    at = field.shape[axis] if closed else field.shape[axis] - 1
    return np.insert(field, [at], middle, axis)


def restored(field, axis, closed, size):
    """The inverse of `doubled`, for a field that had `size` entries along the axis."""
    surplus = field.shape[axis] - size
    return np.delete(field, field.shape[axis] - (1 if closed else 2), axis) if surplus else field


def quadratic_cells(ni, nj, closed, u):
    """Elements (m, 9) of the lattice: corners counter-clockwise, middles of the edges, the centre."""
    i, j = np.meshgrid(np.arange(0, ni if closed else ni - 1, 2), np.arange(0, nj - 1, 2), indexing="ij")
    steps = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1))
    cells = np.stack([((i + a) % ni) * nj + j + b for a, b in steps], axis=-1).reshape(-1, 9)
    a, b, c, d = u.reshape(-1, 2)[cells[0, :4]]
    left_handed = np.linalg.det([c - a, d - b]) < 0.0
    return cells[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]] if left_handed else cells


class Sheet:
    """The sheet of a question as a finite-element field."""

    def __init__(self, asked):
        self.closed = closed = bool(asked["closed"])
        u, r, fixed = (doubled(doubled(asked[k], 0, closed), 1, False) for k in ("u", "r", "fixed"))
        self.shapes = asked["u"].shape[:2], u.shape[:2]
        cells = quadratic_cells(*u.shape[:2], closed, u)
        u, r, fixed = u.reshape(-1, 2), r.reshape(-1, 3), fixed.ravel()
        young, poisson, self.thickness = (float(asked[k]) for k in ("young", "poisson", "thickness"))
        if asked["model"] == "plate":
            self.law, self.weight = Solid(young, poisson), 1.0
            self._as_solid(u, r, fixed, cells)
        else:
            self.law, self.weight = Membrane(young, poisson, asked["model"] == "relaxed"), self.thickness
            planar = np.ptp(r[:, 2]) == 0.0
            self.start = r[:, :2] - u if planar else r - np.column_stack([u, 0.0 * u[:, 0]])
            self.fixed = fixed
            self.region = fem.RegionBiQuadraticQuad(fem.Mesh(u, cells, "quad9"))
        self.field = fem.FieldContainer([fem.Field(self.region, dim=self.start.shape[1])])
        self.body = fem.SolidBody(material(self.law), self.field)
        held = fem.Boundary(self.field[0], mask=self.fixed)
        self.outside, self.inside = fem.dof.partition(self.field, {"held": held})

    def _as_solid(self, u, r, fixed, cells):
        """One layer of hexahedra: the lattice's nodes on the lower face, in the middle and on the upper face."""
        n, half = len(u), 0.5 * self.thickness
        low, high, upright = cells, cells + 2 * n, cells + n
        hexahedra = np.concatenate(
            [low[:, :4], high[:, :4], low[:, 4:8], high[:, 4:8], upright[:, :4]]
            + [upright[:, [7, 5, 4, 6]], low[:, 8:], high[:, 8:], upright[:, 8:]],
            axis=1,
        )
        flat, lift = np.column_stack([u, 0.0 * u[:, 0]]), np.array([0.0, 0.0, half])
        self.start = np.tile(r - flat, (3, 1))
        self.fixed = np.concatenate([0 * fixed, fixed, 0 * fixed]).astype(bool)
        mesh = fem.Mesh(np.concatenate([flat - lift, flat, flat + lift]), hexahedra, "hexahedron27")
        self.region = fem.RegionTriQuadraticHexahedron(mesh)

    def newton(self, share):
        """Newton's method with `share` of the load; returns the iterations."""
        result = fem.newtonraphson(
            items=[self.body],
            dof0=self.outside,
            dof1=self.inside,
            ext0=share * self.start.ravel()[self.outside],
            maxiter=ITERATIONS,
            tol=TOLERANCE,
            verbose=0,
            solver=factorised,
        )
        return result.iterations

    def solve(self, load_steps):
        """Iterations from the start to the answer, or in load steps from the flat sheet with a part of its noise."""
        shares = np.arange(1, load_steps + 1) / load_steps
        self.field[0].values[:] = shares[0] * self.start
        count = 0
        for softness in self.law.softness:
            self.law.soft = softness
            for share in shares if softness == self.law.softness[0] else shares[-1:]:
                count += self.newton(share)
        return count

    def energy(self):
        """Strain energy, N mm."""
        return self.weight * float((self.law.second(self.field.extract()[0])[2] * self.region.dV).sum())

    def positions(self):
        """Positions (ni, nj, 3) of the middle surface at the nodes of the question."""
        (ni, nj), doubled_shape = self.shapes
        points, moved = self.region.mesh.points, self.field[0].values
        place = np.zeros((len(points), 3))
        place[:, : points.shape[1]] = points
        place[:, : moved.shape[1]] += moved
        if isinstance(self.law, Solid):
            place = place[len(place) // 3 : 2 * len(place) // 3]
        place = place.reshape(*doubled_shape, 3)
        return restored(restored(place, 0, self.closed, ni), 1, False, nj)


def attempts(sheet):
    """How the sheet ended: (status, message, iterations)."""
    said = ""
    for load_steps in (1, LOAD_STEPS):
        try:
            return (
                "converged",
                "" if load_steps == 1 else f"in {load_steps} load steps",
                sheet.solve(load_steps),
            )
        except (ValueError, RuntimeError) as error:  # the words of FElupe and of SuperLU for what fails
            said = str(error).strip().splitlines()[0]
    return "not converged", said, 0


def main(question, answer):
    """Answer a question."""
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
    with np.load(question) as stored:
        asked = {name: stored[name] for name in stored.files}
    began = time.process_time()
    sheet = Sheet(asked)
    status, message, iterations = attempts(sheet)
    found = {"status": status, "message": message[:300], "iterations": iterations}
    found |= {"energy": sheet.energy(), "cpu_seconds": time.process_time() - began}
    found |= {"versions": {"felupe": fem.__version__}}
    np.savez(answer, r=sheet.positions(), found=json.dumps(found))


if __name__ == "__main__":
    with np.errstate(all="ignore"):
        main(sys.argv[1], sys.argv[2])
