# hmax_unity(TARGET): compiles the sources of a target in batches, which parse its headers and instantiate their templates
# once. No two sources of such a target may have one name in an anonymous namespace, nor have one there that a header of
# namespace hmax gives to something else: tests/architecture/batches_test.cpp checks it. Sources with options of their own are
# compiled alone. HMAX_UNITY=OFF (preset dev) compiles each alone, which shows that it includes what it uses.
option(HMAX_UNITY "Compile the sources of upper rooms and tests in batches" ON)

function(hmax_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${HMAX_UNITY} UNITY_BUILD_BATCH_SIZE 8)
endfunction()
