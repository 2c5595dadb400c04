"""What the tests of the Python package share."""

import os
import subprocess

import numpy as np
import pytest


def spring_chain(n, k=100.0, m=0.01):
    """K and the masses of n equal masses on n + 1 springs between two walls.

    Closed form: omega_j = 2 sqrt(k / m) sin(j pi / (2 (n + 1))).
    """
    K = 2 * k * np.eye(n) - k * np.eye(n, k=1) - k * np.eye(n, k=-1)
    omega = 2 * np.sqrt(k / m) * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1)))
    return K, np.full(n, m), omega


@pytest.fixture
def program():
    """Runs the program hmax and returns what it prints."""
    path = os.environ.get("HMAX_PROGRAM")
    if not path:
        pytest.skip("HMAX_PROGRAM does not name the program")
    return lambda *arguments: subprocess.run([path, *arguments], check=False, capture_output=True, text=True)
