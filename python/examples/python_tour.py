# %% [markdown]
# # A tour of hmax in Python
# Which integrator, and how large a step? This page was made by `scripts/notebook python/examples/python_tour.py`; the text below each
# block is what it printed. matplotlib draws the figures, hmax itself needs numpy and scipy only.

# %%
import matplotlib.pyplot as plt
import numpy as np
import scipy.sparse as sparse

import hmax

print(f"hmax {hmax.__version__}: {len(hmax.methods())} methods")

# %% [markdown]
# ## Where a method is stable
# A step of size h multiplies a mode with eigenvalue λ by R(hλ). The region where |R| ≤ 1 decides how large h may be.

# %%
for colour, method in enumerate(["explicit_euler", "rk4", "ode45"]):
    for curve in hmax.region(method).curves:
        plt.plot(curve[:, 0], curve[:, 1], f"C{colour}")
    plt.plot([], [], f"C{colour}", label=method)
plt.axvline(0, color="0.7", lw=0.8), plt.axhline(0, color="0.7", lw=0.8)
plt.axis("equal"), plt.xlabel("Re hλ"), plt.ylabel("Im hλ"), plt.legend()
plt.title("Boundaries of stability regions")

print("method          real    imaginary  A-stable")
for method in ["explicit_euler", "rk4", "ode45", "bdf_3", "trapezoidal"]:
    row = hmax.limits(method)
    print(f"{row.method:18} {row.real:6.4g} {row.imaginary:8.4g}    {row.a_stable}")

# %% [markdown]
# ## The largest stable step of matrices
# A chain of 50 masses between two walls. Its fastest mode is known, ω = 2 √(k/m) sin(nπ / 2(n+1)), and RK4 is stable up to √8 / ω.

# %%
n, k, m = 50, 100.0, 0.01  # N/m, kg
K = sparse.diags([2 * k, -k, -k], [0, 1, -1], shape=(n, n))
M = np.full(n, m)
omega = 2 * np.sqrt(k / m) * np.sin(n * np.pi / (2 * (n + 1)))
limit = hmax.largest_stable_step("rk4", K, M, verify=True)
print(f"closed form {np.sqrt(8) / omega:.8f} s")
print(f"predicted   {limit.h_max:.8f} s, limited by {limit.bound}")
print(f"observed    {limit.observed:.8f} s, in runs of the method")

# %% [markdown]
# Just below the limit RK4 damps the fastest modes; just above it they grow, and soon nothing else is seen.

# %%
start = np.concatenate([np.exp(-0.1 * (np.arange(n) - 25.0) ** 2) * 0.01, np.zeros(n)])
for factor in [0.99, 1.01]:
    h = factor * limit.h_max
    run = hmax.integrate("rk4", K=K, M=M, y0=start, t_end=h * round(5 / h), h=h)
    q, v = run.y[:, :n], run.y[:, n:]
    energy = 0.5 * m * (v**2).sum(axis=1) + 0.5 * np.einsum("ti,ti->t", q, (K @ q.T).T)
    plt.semilogy(run.t, energy / energy[0], label=f"h = {factor} h_max")
    print(f"{factor} h_max: {run.outcome} after {run.stats['steps']} steps, energy times {energy[-1] / energy[0]:.3g}")
plt.xlabel("t [s]"), plt.ylabel("energy over that at the start"), plt.legend(), plt.title("RK4 at its limit")

# %% [markdown]
# ## A liver
# A body on a mesh has its matrices at any state. Its limit falls with the square root of the stiffness.

# %%
mesh = hmax.read_mesh("liver")
print(f"{len(mesh.points)} points, {len(mesh.tetrahedra)} tetrahedra")
young = np.geomspace(500, 50000, 7)  # Pa
for method in ["symplectic_euler", "rk4", "dop_853"]:
    steps = []
    for E in young:
        body = hmax.Body(mesh, "fem_corotational", E=E)
        steps.append(hmax.largest_stable_step(method, body.K(), body.M(), body.C()).h_max)
    plt.loglog(young / 1000, 1000 * np.array(steps), "o-", label=method)
    print(f"{method:17} {1000 * steps[0]:7.3f} ms at 0.5 kPa, {1000 * steps[-1]:7.3f} ms at 50 kPa")
plt.xlabel("Young's modulus [kPa]"), plt.ylabel("h_max [ms]"), plt.legend(), plt.title("Largest stable step of a liver of 1151 tetrahedra")

# %%
body = hmax.Body(mesh, "fem_corotational", material="liver:male_normal")
slow = hmax.modes(body.K(), body.M(), body.C(), count=5)
fast = hmax.modes(body.K(), body.M(), body.C(), count=1, fastest=True)
print("slowest modes [Hz]:", slow.frequency.round(3))
print("fastest mode  [Hz]:", fast.frequency.round(1))
share = np.sort((fast.shapes[:, 0].reshape(-1, 3) ** 2).sum(axis=1))[::-1]
print(f"five of {len(share)} points have {100 * share[:5].sum() / share.sum():.0f} % of the motion of the fastest mode")

# %% [markdown]
# ## A step function of your own
# `probe` differentiates any `step(y, h)` and finds where its motions begin to grow. Here: linearly implicit Euler with the Jacobian of a
# body a sixth as stiff, as a Jacobian is that was made before the body stiffened.

# %%
A = np.array([[200.0, -100.0], [-100.0, 100.0]])


def step(y, h):
    q, v = y[:2], y[2:]
    v = v + np.linalg.solve(np.eye(2) + h * h * A / 6, -h * A @ (q + h * v / 6))
    return np.concatenate([q + h * v, v])


found = hmax.probe(step, np.zeros(4), h0=0.01, h1=1, verify=True)
print(f"h_max {found.h_max:.5f} s, runs show {found.observed:.5f} s")
h = np.array([row.h for row in found.rows])
plt.semilogx(h, [row.spectral_radius for row in found.rows], "o-")
plt.axhline(1, color="0.7", lw=0.8), plt.axvline(found.h_max, color="0.7", lw=0.8)
plt.xlabel("h [s]"), plt.ylabel("spectral radius of a step"), plt.title("Where the motions of a step begin to grow")

# %% [markdown]
# ## Advice
# `advise` runs and times the candidates on a probing motion. What it recommends depends on the machine.

# %%
advice = hmax.advise(hmax.Body("phantom", "mass_spring", material="liver:male_normal"), rate=100, frames=200)
print(f"{advice.model} at {advice.rate:g} Hz")
for row in advice.rows[:6]:
    print(f"{row.method:24} h = {1000 * row.h:6.3f} ms  error {100 * row.error:6.3f} %  frame {row.frame_ms.p99:6.3f} ms  {row.verdict}")
