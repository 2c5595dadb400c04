# Required packages stop the configuration with the name of the Debian package; optional ones are reported.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)   # libeigen3-dev
find_package(fmt REQUIRED)                    # libfmt-dev
find_package(CLI11 REQUIRED)                  # libcli11-dev
find_package(nlohmann_json REQUIRED)          # nlohmann-json3-dev
find_package(tomlplusplus REQUIRED)           # libtomlplusplus-dev
find_package(SQLite3 REQUIRED)                # libsqlite3-dev
find_package(muparser REQUIRED)               # libmuparser-dev

find_package(Boost 1.74 QUIET)                # libboost-dev: Boost.Odeint as a peer and as a reference engine
find_package(SUNDIALS QUIET COMPONENTS arkode cvode nvecserial)   # libsundials-dev
find_program(HMAX_GNUPLOT gnuplot)            # gnuplot-nox: figures
