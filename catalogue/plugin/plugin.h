/* Models and steppers of your own for hmax, in a shared library: hmax probe --plugin FILE.so[:NAME[:ARGUMENT]].
 *
 * C99, no dependencies, no allocation across the border: hmax passes arrays of its own, the plugin fills them.
 *
 *   #include <hmax/plugin.h>
 *   static const hmax_plugin_entry entries[] = {{.name = "chain", .note = "...", .stepper = &chain}};
 *   static const hmax_plugin plugin = {HMAX_PLUGIN_VERSION, 1, entries};
 *   HMAX_PLUGIN_EXPORT const hmax_plugin* hmax_plugin_get(void) { return &plugin; }
 *
 *   cc -shared -fPIC -I PREFIX/include chain.c -o chain.so
 *
 * Process.   The plugin is loaded into a child process of hmax. A crash, an exit or a function that does not return
 *            within `--patience` seconds ends the child and is an error of the command. What the plugin writes to
 *            standard output and standard error appears on standard error, up to 100,000 characters; more than 64 MB
 *            are an error. At the end hmax ends all processes that the plugin has started.
 * Threads.   All functions are called from one thread, one at a time. The plugin may have threads of its own, which rest
 *            when a function returns. Results that depend on their order are reported as not reproducible.
 * Lifetime.  hmax_plugin_get() is called once. Its tables live as long as the library. create() comes first, then the
 *            other functions with its handle in any order, destroy() last. There may be several handles at a time.
 * Ownership. Arrays belong to hmax and are valid during the call only. Strings that the plugin returns belong to the
 *            plugin and stay valid until the next call with the same handle.
 * Alignment. Arrays of double and saved states begin at multiples of 64 bytes.
 * Numbers.   All arrays are double, also those of engines in single precision. NaN and infinity are results, not errors:
 *            a state that holds one has diverged. At the start all numbers must be finite.
 * Errors.    A function returns 0 (HMAX_OK) or a code of its own from 2 on; error_text() then says why in a sentence.
 *            C++ exceptions must not leave a function.
 * Optional.  Functions marked so may be NULL.
 * Matrices.  Dense, column by column: entry (i, j) of an n-row matrix is at i + n * j.
 */
#ifndef HMAX_PLUGIN_H
#define HMAX_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

/* Raised when a table grows. Plugins of earlier versions go on to work; hmax refuses later ones than its own. */
#define HMAX_PLUGIN_VERSION 3u

#define HMAX_OK 0
/* Of step(): it cannot be done at this size, as a solver that does not converge. hmax counts it as divergence. */
#define HMAX_DIVERGED 1

/* The engine computes in float: differences of states are taken over larger increments. */
#define HMAX_SINGLE_PRECISION 1u

#if defined(__GNUC__)
#define HMAX_PLUGIN_VISIBLE __attribute__((visibility("default")))
#else
#define HMAX_PLUGIN_VISIBLE
#endif
#ifdef __cplusplus
#define HMAX_PLUGIN_EXPORT extern "C" HMAX_PLUGIN_VISIBLE
#else
#define HMAX_PLUGIN_EXPORT HMAX_PLUGIN_VISIBLE
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What models and steppers have in common.
 * argument   what follows NAME on the command line, "" without one: a scene, a size
 * handle     whatever the plugin needs to know again; may be NULL */
typedef struct hmax_object {
  int (*create)(const char* argument, void** handle);
  void (*destroy)(void* handle);                      /* optional */
  const char* (*error_text)(void* handle);            /* optional; of a create() that failed, with what it set */
  int (*dimension)(void* handle, size_t* n);          /* numbers of the state, at least 1, always the same */
} hmax_object;

/* A part of a scene that has a stiffness or a damping: a joint, a spring, an actuator. */
typedef struct hmax_part {
  const char* kind;          /* "joint" */
  const char* name;          /* in the scene */
  double stiffness, damping; /* as in the scene; 0 where it has none */
} hmax_part;

/* An engine that advances its own state. */
typedef struct hmax_stepper {
  hmax_object object;
  uint32_t flags; /* 0 or HMAX_SINGLE_PRECISION */
  int (*get_state)(void* handle, double* y); /* n numbers: positions and velocities, or what the engine has */
  int (*set_state)(void* handle, const double* y);
  int (*step)(void* handle, double h); /* advances by h seconds */

  /* All that the next steps depend on: the state, its time, warm starts, contact caches. saved_size() is asked before each
   * save() and may change. An engine without hidden state leaves all three NULL: its state is saved. */
  size_t (*saved_size)(void* handle); /* bytes */
  int (*save)(void* handle, void* blob);
  int (*restore)(void* handle, const void* blob, size_t bytes);

  /* optional: indices of the first of four consecutive numbers of the state that are a unit quaternion, in any order of its
   * parts. Called with first == NULL for their number. */
  int (*quaternions)(void* handle, size_t* count, size_t* first);
  /* optional: n positive numbers, the size of a noticeable change of each number of the state. Without it hmax takes the
   * sizes of the numbers at the start. */
  int (*scales)(void* handle, double* scale);

  /* optional, since version 2: which numbers of the state a step couples. hmax then differentiates many of them at once. It
   * compares the result with a step, and says so if a coupling is missing.
   *   group   n indices below n: numbers of one body have the same one
   *   pairs   pairs of groups that act on each other, as by a spring; each group acts on itself
   *   reach   how many pairs in a row a step crosses: 1 (the default) as with symplectic Euler, 4 as with RK4
   * Called with group == NULL and pairs == NULL for the count of pairs. */
  int (*couplings)(void* handle, size_t* count, size_t* reach, size_t* group, size_t (*pairs)[2]);

  /* optional, since version 3: the step size that the scene asks for [s] */
  int (*own_step)(void* handle, double* h);
  /* optional, since version 3, both or none: up to 10,000 parts, called with parts == NULL for their count; and what a
   * part has from then on, as factors of its stiffness and of its damping in the scene. hmax finds the part that the
   * largest stable step rests on. */
  int (*parts)(void* handle, size_t* count, hmax_part* parts);
  int (*scale_part)(void* handle, size_t part, double stiffness, double damping);
} hmax_stepper;

/* Equations of motion: y' = rhs(t, y), or with force != NULL a diagonal mass and forces,
 *   M q'' = force(t, q, q'), n = 2 m, y = (q, q'). rhs is then optional. */
typedef struct hmax_model {
  hmax_object object;
  int (*start)(void* handle, double* y0, double* t_end); /* the initial state, and the default end time in seconds */
  int (*rhs)(void* handle, double t, const double* y, double* dydt);
  int (*jacobian)(void* handle, double t, const double* y, double* J); /* optional: n x n, d rhs / d y */

  int (*mass)(void* handle, double* mass);                                        /* m numbers, positive */
  int (*force)(void* handle, double t, const double* q, const double* v, double* f);     /* m numbers */
  int (*stiffness)(void* handle, double t, const double* q, const double* v, double* K); /* optional: m x m, -d force / d q */
  int (*damping)(void* handle, double t, const double* q, const double* v, double* C);   /* optional: m x m, -d force / d v */

  const char* (*state_name)(void* handle, size_t i); /* optional, since version 3: of number i of a state of up to 10,000 */
} hmax_model;

/* Exactly one of model and stepper is not NULL. */
typedef struct hmax_plugin_entry {
  const char* name; /* letters, digits and _ */
  const char* note; /* one line for people */
  const hmax_model* model;
  const hmax_stepper* stepper;
} hmax_plugin_entry;

typedef struct hmax_plugin {
  uint32_t version; /* HMAX_PLUGIN_VERSION */
  uint32_t count;   /* of entries; without NAME the first one that is what the command takes: a model, for probe a stepper */
  const hmax_plugin_entry* entries;
} hmax_plugin;

/* The one symbol that a plugin exports. */
HMAX_PLUGIN_VISIBLE const hmax_plugin* hmax_plugin_get(void);

#ifdef __cplusplus
}
#endif

#endif
