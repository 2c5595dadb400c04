from spack.package import *


class CmarkGfm(CMakePackage):
    """Markdown of GitHub as HTML, and its extensions."""

    homepage = "https://github.com/github/cmark-gfm"
    git = "https://github.com/github/cmark-gfm.git"

    license("BSD-2-Clause")

    version("0.29.0.gfm.13", tag="0.29.0.gfm.13")

    depends_on("c", type="build")

    def cmake_args(self):
        return [self.define("CMARK_TESTS", False)]
