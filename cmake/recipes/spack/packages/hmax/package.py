from spack.package import *


class Hmax(CMakePackage):
    """The largest stable step of an integrator on soft-tissue models."""

    license("MIT")

    # spack dev-build builds the checkout that it is started in.
    version("0.2.0")

    variant("sundials", default=True, description="Methods cvode_* and arkode_*")
    variant("boost", default=True, description="Methods odeint_*")
    variant("python", default=False, description="Python package")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("eigen@3.4")
    depends_on("fmt@9:")
    depends_on("nlohmann-json")
    depends_on("tomlplusplus")
    depends_on("sqlite")
    depends_on("cmark-gfm")
    depends_on("cli11@2:")
    depends_on("metis")
    depends_on("zlib-api")
    depends_on("lz4")
    depends_on("xz")
    depends_on("boost@1.74:", when="+boost")
    depends_on("sundials@6.4:6 +klu", when="+sundials")
    depends_on("py-pybind11@2.10:", type="build", when="+python")
    depends_on("py-numpy", type=("build", "run"), when="+python")
    depends_on("py-scipy", type=("build", "run"), when="+python")
    extends("python@3.9:", when="+python")

    def cmake_args(self):
        return [
            self.define("HMAX_BUILD_TESTS", False),
            self.define("HMAX_BUILD_MICRO", False),
            self.define_from_variant("HMAX_BUILD_PYTHON", "python"),
        ]
