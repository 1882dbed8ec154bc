/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into a program (LD_PRELOAD), this library makes a folder behave as one on a slow network file system that
   several machines share. SCANMILL_TEST_NETWORK names the folder, SCANMILL_TEST_HOST this machine. Below the folder:
   - there are no unnamed files, and no locks: a lock ends the program;
   - every call takes up to some milliseconds, so that the calls of several programs are shuffled;
   - some calls are carried out, but their answers are lost, and the repeated call fails: link() with EEXIST, rename()
     with ENOENT;
   - some files that exist cannot be opened at the first attempt (ESTALE). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/vfs.h>
#include <time.h>
#include <unistd.h>

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static unsigned chance(unsigned most) {
    static __thread unsigned seed;
    struct timespec now;
    if (seed == 0) {
        clock_gettime(CLOCK_MONOTONIC, &now);
        seed = (unsigned)getpid() * 7919u + (unsigned)now.tv_nsec;
    }
    return (unsigned)rand_r(&seed) % most;
}

static int is_on_network(const char* path) {
    const char* folder = getenv("SCANMILL_TEST_NETWORK");
    return folder && path && strncmp(path, folder, strlen(folder)) == 0;
}

static int is_open_on_network(int descriptor) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = '\0';
    return is_on_network(path);
}

static void wait_for_answer(void) {
    const struct timespec delay = {0, (long)chance(3000) * 1000};
    nanosleep(&delay, NULL);
}

static int open_file(__typeof__(&open) next, const char* path, int flags, mode_t mode) {
    static __thread unsigned stale;
    if (!is_on_network(path)) return next(path, flags, mode);
    wait_for_answer();
    if ((flags & O_TMPFILE) == O_TMPFILE) {
        errno = EOPNOTSUPP;
        return -1;
    }
    /* Not twice in a row: the server then gives the new handle. */
    stale = (flags & (O_CREAT | O_DIRECTORY)) == 0 && access(path, F_OK) == 0 && !stale && chance(5) == 0;
    if (stale) {
        errno = ESTALE;
        return -1;
    }
    return next(path, flags, mode);
}

#define OPEN(name)                                             \
    int name(const char* path, int flags, ...) {               \
        mode_t mode = 0;                                       \
        if (flags & (O_CREAT | __O_TMPFILE)) {                 \
            va_list rest;                                      \
            va_start(rest, flags);                             \
            mode = va_arg(rest, mode_t);                       \
            va_end(rest);                                      \
        }                                                      \
        return open_file(NEXT(name), path, flags, mode);       \
    }
OPEN(open)
OPEN(open64)

int link(const char* from, const char* to) {
    if (is_on_network(to)) wait_for_answer();
    const int result = NEXT(link)(from, to);
    if (result == 0 && is_on_network(to) && chance(4) == 0) {
        errno = EEXIST;
        return -1;
    }
    return result;
}

int rename(const char* from, const char* to) {
    if (is_on_network(to)) wait_for_answer();
    const int result = NEXT(rename)(from, to);
    if (result == 0 && is_on_network(to) && chance(4) == 0) {
        errno = ENOENT;
        return -1;
    }
    return result;
}

int unlink(const char* path) {
    if (is_on_network(path)) wait_for_answer();
    return NEXT(unlink)(path);
}

int fsync(int descriptor) {
    if (is_open_on_network(descriptor)) wait_for_answer();
    return NEXT(fsync)(descriptor);
}

static void refuse_lock(void) {
    static const char text[] = "a lock was asked for on a network file system\n";
    if (write(STDERR_FILENO, text, sizeof text - 1) < 0) _exit(98);
    _exit(99);
}

int flock(int descriptor, int operation) {
    if (is_open_on_network(descriptor)) refuse_lock();
    return NEXT(flock)(descriptor, operation);
}

static int control(__typeof__(&fcntl) next, int descriptor, int command, void* argument) {
    const int locks = command == F_SETLK || command == F_SETLKW || command == F_OFD_SETLK || command == F_OFD_SETLKW;
    if (locks && is_open_on_network(descriptor)) refuse_lock();
    return next(descriptor, command, argument);
}

#define CONTROL(name)                                               \
    int name(int descriptor, int command, ...) {                    \
        va_list rest;                                               \
        va_start(rest, command);                                    \
        void* argument = va_arg(rest, void*);                       \
        va_end(rest);                                               \
        return control(NEXT(name), descriptor, command, argument);  \
    }
CONTROL(fcntl)
CONTROL(fcntl64)

int statfs(const char* path, struct statfs* system) {
    const int result = NEXT(statfs)(path, system);
    if (result == 0 && is_on_network(path)) system->f_type = NFS_SUPER_MAGIC;
    return result;
}

int gethostname(char* name, size_t size) {
    const char* host = getenv("SCANMILL_TEST_HOST");
    if (!host) return NEXT(gethostname)(name, size);
    snprintf(name, size, "%s", host);
    return 0;
}
