/*
 * Sandgate: granular flow as a component that you step. Plain C interface (C99, C++17).
 *
 * Link libsandgate_fmu.so (or libsandgate_fmu.a), made by `cargo build --release -p sandgate-fmu`. docs/c.md is the
 * manual: every function, its errors, who owns what for how long; examples/c/silo.c and examples/ctypes_silo.py use it.
 *
 * Rules for all functions
 *   Threads    Different instances may be used at the same time from different threads. Calls on one instance must
 *              come one after the other (from any thread); a second call at the same time is refused.
 *   Units      SI throughout: m, kg, s, N, Pa. Times are f64 seconds.
 *   Memory     What you pass in is read (or written) during the call only and stays yours. What you get as
 *              `const char *` belongs to the library; how long it stays is said at each function.
 *   Errors     Functions that return int32_t give a sandgate_status; sandgate_last_error has the text. A refused call
 *              changes nothing and the instance goes on (SANDGATE_OUTSIDE of a step, restore or terminate in which a
 *              required log failed: the call was done); after SANDGATE_STEP_FAILED only reading, restore, reset and
 *              terminate are allowed; after SANDGATE_BROKEN only restore, reset and free. No call changes the
 *              locale, the working directory, signal handlers or the floating-point mode, and none ends the process, but
 *              where memory runs out, or a log meets a limit of file sizes with SIGXFSZ not ignored (docs/c.md).
 *   Files      None is read or written but those that you name: by sandgate_create_from_file and by the parameters
 *              log.path (docs/logs.md) and zenoh.config (docs/zenoh.md).
 *   Results    The same calls give the same bits, whatever the number of threads.
 */
#ifndef SANDGATE_H
#define SANDGATE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Number of this interface. It changes when an existing program would have to be compiled again. */
#define SANDGATE_ABI_VERSION 1

/* What functions return. */
typedef enum sandgate_status {
    SANDGATE_OK = 0,
    SANDGATE_SCENE = 1,        /* the scene cannot be read or built */
    SANDGATE_NOT_NOW = 2,      /* the call is not allowed in this mode */
    SANDGATE_BAD_ARGUMENT = 3, /* NULL, wrong length, unknown reference, out of range, not finite */
    SANDGATE_STEP_FAILED = 4,  /* the solver gave up: the component is in mode SANDGATE_FAILED */
    SANDGATE_BAD_STATE = 5,    /* saved bytes that cannot be used: another scene or version, cut short, changed */
    SANDGATE_BROKEN = 6,       /* a fault inside the library; please report it */
    SANDGATE_OUTSIDE = 7       /* the log or the Zenoh session that parameters ask for cannot be opened or written */
} sandgate_status;

/* Where a component is in its life. */
typedef enum sandgate_mode {
    SANDGATE_INSTANTIATED = 0,
    SANDGATE_INITIALIZATION = 1,
    SANDGATE_STEPPING = 2,
    SANDGATE_TERMINATED = 3,
    SANDGATE_FAILED = 4
} sandgate_mode;

typedef enum sandgate_causality {
    SANDGATE_INDEPENDENT = 0,
    SANDGATE_PARAMETER = 1,
    SANDGATE_INPUT = 2,
    SANDGATE_OUTPUT = 3
} sandgate_causality;

typedef enum sandgate_variability {
    SANDGATE_FIXED = 0,
    SANDGATE_TUNABLE = 1,
    SANDGATE_DISCRETE = 2,
    SANDGATE_CONTINUOUS = 3
} sandgate_variability;

/* What a value means; all but texts travel as double. */
typedef enum sandgate_kind {
    SANDGATE_REAL = 0,
    SANDGATE_INTEGER = 1, /* whole numbers: counts, validity (0 valid, 1 empty, 2 outside, 3 blocked) */
    SANDGATE_BOOLEAN = 2, /* 0 or 1 */
    SANDGATE_TEXT = 3     /* only by sandgate_set_text and sandgate_get_text */
} sandgate_kind;

/* A component. Made by sandgate_create..., freed by sandgate_free. */
typedef struct sandgate_instance sandgate_instance;

/* One row of the table of variables. Texts belong to the instance and stay until sandgate_free. */
typedef struct sandgate_variable {
    const char *name;         /* "gate.main.opening" */
    const char *description;  /* one line for people */
    const char *unit;         /* SI unit: "m", "kg/s", "1" */
    const char *display_unit; /* unit people like to see, "" if none */
    double display_factor;    /* value in display_unit = value * display_factor */
    double minimum;           /* smallest allowed value, -infinity if none */
    double maximum;           /* largest allowed value, infinity if none */
    uint64_t length;          /* number of values: 1 for a scalar */
    uint32_t reference;       /* handle for get and set; equals the row's place in the table */
    int32_t causality;        /* sandgate_causality */
    int32_t variability;      /* sandgate_variability */
    int32_t kind;             /* sandgate_kind */
    int32_t has_start;        /* 1 if the start value is given by the scene, 0 if it is computed */
    int32_t is_element;       /* 1 if this scalar is also an element of the array row `element_of` */
    uint32_t element_of;      /* reference of that array */
    uint32_t element_index;   /* place in it, from 0 */
} sandgate_variable;

/* What a step did. */
typedef struct sandgate_step_report {
    double time;            /* time reached: t + h, bit for bit [s] */
    double smallest_step;   /* smallest internal step [s] */
    uint32_t substeps;      /* internal steps; UINT32_MAX for more */
    uint32_t iterations;    /* iterations of viscous solves, in all; UINT32_MAX for more */
} sandgate_step_report;

/* Account of material; initial + inflow - outflow = present, exactly [kg]. */
typedef struct sandgate_ledger {
    double initial;
    double inflow;
    double outflow;
    double present;
} sandgate_ledger;

/* Bits of sandgate_capabilities. */
typedef enum sandgate_capability {
    SANDGATE_CAN_GO_BACK = 1,         /* save and restore in every mode, to the bit, also in another process */
    SANDGATE_CAN_VARY_STEPS = 2,      /* any h, and steps end at t + h exactly */
    SANDGATE_CAN_RUN_IN_PARALLEL = 4, /* several instances at once, from one thread or several */
    SANDGATE_CAN_USE_THREADS = 8,     /* sandgate_set_threads, without a change of results */
    SANDGATE_CAN_LOG = 16,            /* sandgate_set_logger */
    SANDGATE_CAN_RECORD = 32,         /* the parameter log.path: an MCAP log of all traffic */
    SANDGATE_CAN_PUBLISH = 64         /* the parameter zenoh.config: publications and set-points on Zenoh */
} sandgate_capability;

/*
 * Gets what an instance has to say, during a call on it and from that call's thread. `user` is the pointer given to
 * sandgate_set_logger. `category` is "logStatusError" for refused and failed calls, or another of the categories that
 * docs/c.md lists. Both texts stay until the logger returns. It must return, and must not call the same instance.
 */
typedef void (*sandgate_logger)(void *user, const char *category, const char *message);

/* SANDGATE_ABI_VERSION of the library. Compare it with the header's before anything else. */
uint32_t sandgate_abi_version(void);

/* Version of the program, three numbers with points between them. Stays as long as the library is loaded. */
const char *sandgate_version(void);

/* What the library can do: bits of sandgate_capability. Ask before you rely on one that a later version may add. */
uint32_t sandgate_capabilities(void);

/*
 * Makes a component from the text of a scene file (UTF-8, ends with a zero byte). `name` is what messages call the
 * file; it may be NULL. On refusal gives NULL and writes the reasons into `error` (cut to `error_size`, always ended
 * by a zero byte); `error` may be NULL if `error_size` is 0. The component is in mode SANDGATE_INSTANTIATED and uses
 * one thread.
 */
sandgate_instance *sandgate_create(const char *scene_text, const char *name, char *error, size_t error_size);

/* The same, from a file. */
sandgate_instance *sandgate_create_from_file(const char *path, char *error, size_t error_size);

/* Frees a component and everything that belongs to it. NULL is allowed. */
void sandgate_free(sandgate_instance *instance);

/*
 * Text of the last refused or failed call on this instance, "" if there was none. Stays until the next call on the
 * instance. Never NULL.
 */
const char *sandgate_last_error(const sandgate_instance *instance);

/*
 * From now on `logger` gets messages, with `user` passed through unread. NULL ends it; a new component has none. `user`
 * must stay usable until then or until sandgate_free. Logging changes no result.
 */
int32_t sandgate_set_logger(sandgate_instance *instance, sandgate_logger logger, void *user);

/* Rows of the table of variables; 0 if `instance` is NULL. References are 0 to count - 1. */
uint32_t sandgate_variable_count(const sandgate_instance *instance);

/* Writes the row with this reference. */
int32_t sandgate_variable_info(const sandgate_instance *instance, uint32_t reference, sandgate_variable *variable);

/* Writes the reference of the variable with this name. */
int32_t sandgate_variable_by_name(const sandgate_instance *instance, const char *name, uint32_t *reference);

/* SANDGATE_INSTANTIATED -> SANDGATE_INITIALIZATION. `stop`: no step may end later [s]; INFINITY for no end. */
int32_t sandgate_enter_initialization(sandgate_instance *instance, double start, double stop);

/* SANDGATE_INITIALIZATION -> SANDGATE_STEPPING: the first gauges are sampled. */
int32_t sandgate_exit_initialization(sandgate_instance *instance);

/* Both in one. */
int32_t sandgate_initialize(sandgate_instance *instance, double start, double stop);

/*
 * Sets variables, all or none. `values` has the values of all references, one after the other: as many as the lengths
 * of the variables add up to, which must be `value_count`.
 */
int32_t sandgate_set(sandgate_instance *instance, const uint32_t *references, size_t reference_count,
                     const double *values, size_t value_count);

/*
 * Reads variables; arguments as in sandgate_set. Changes nothing, computes nothing, except before initialisation ends and
 * after a fixed parameter was set: an output builds the scene anew then, and SANDGATE_SCENE or SANDGATE_BAD_ARGUMENT
 * says that the parameters make none.
 */
int32_t sandgate_get(const sandgate_instance *instance, const uint32_t *references, size_t reference_count,
                     double *values, size_t value_count);

/*
 * Sets a variable of kind SANDGATE_TEXT (log.path: the file of an MCAP log of all traffic, "" for none). Allowed until
 * initialisation ends. `value` is UTF-8 and ends with a zero byte.
 */
int32_t sandgate_set_text(sandgate_instance *instance, uint32_t reference, const char *value);

/* Reads one. The text stays until the next sandgate_get_text on the instance, or sandgate_free. */
int32_t sandgate_get_text(sandgate_instance *instance, uint32_t reference, const char **value);

/* Advances from `t` (the current time) to t + h exactly. `report` may be NULL. */
int32_t sandgate_step(sandgate_instance *instance, double t, double h, sandgate_step_report *report);

/* Simulated time [s]. */
int32_t sandgate_time(const sandgate_instance *instance, double *time);

/* A sandgate_mode. */
int32_t sandgate_get_mode(const sandgate_instance *instance, int32_t *mode);

/* The account of material. */
int32_t sandgate_get_ledger(const sandgate_instance *instance, sandgate_ledger *ledger);

/* Bytes that sandgate_save will need now. */
int32_t sandgate_save_size(const sandgate_instance *instance, size_t *size);

/*
 * Saves everything that can change a later bit, in any mode. `capacity` is the room at `bytes`; `size` gets what was
 * written. Bytes can be restored in another process, by any interface of the same version, for the same scene.
 */
int32_t sandgate_save(const sandgate_instance *instance, uint8_t *bytes, size_t capacity, size_t *size);

/* Goes back (or forth) to saved bytes, in any mode; refused bytes change nothing. */
int32_t sandgate_restore(sandgate_instance *instance, const uint8_t *bytes, size_t size);

/* Back to SANDGATE_INSTANTIATED with start values. */
int32_t sandgate_reset(sandgate_instance *instance);

/* Ends the simulation: values can still be read. */
int32_t sandgate_terminate(sandgate_instance *instance);

/* Threads of the sweeps, at most 256; 0 means all cores. Results do not depend on it. */
int32_t sandgate_set_threads(sandgate_instance *instance, uint32_t threads);

/*
 * Hash of the state: 64 hexadecimal digits and a zero byte. Components with the same hash go on with the same bits.
 */
int32_t sandgate_state_hash(const sandgate_instance *instance, char hash[65]);

#ifdef __cplusplus
}
#endif

#endif
