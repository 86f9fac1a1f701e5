/* A disk that fails: the n-th call of one kind on files below a folder fails, and every one of that kind after it.
 *
 * CATSEYE_TEST_DISK holds "folder|calls|n|errno|bytes|mark": calls is one of write, sync, make, name or all; a write that
 * fails for want of room takes so many bytes first; the file `mark` gets the name of the call that was the first to fail.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static char folder[PATH_MAX], calls[16], mark[PATH_MAX];
static long left, part;
static int fault, ready, struck;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

__attribute__((constructor)) static void read_order(void) {
    const char *order = getenv("CATSEYE_TEST_DISK");
    if (order && sscanf(order, "%4095[^|]|%15[^|]|%ld|%d|%ld|%4095[^|]", folder, calls, &left, &fault, &part, mark) == 6)
        ready = 1;
}

static void *next(const char *name) { return dlsym(RTLD_NEXT, name); }

/* Whether this call fails; the first one that does leaves its name. */
static int fails(const char *kind, const char *path) {
    char whole[2 * PATH_MAX], here[PATH_MAX];
    if (ready && path && path[0] != '/' && getcwd(here, sizeof here)) {
        snprintf(whole, sizeof whole, "%s/%s", here, path);
        path = whole;
    }
    if (!ready || !path || strncmp(path, folder, strlen(folder)) || (strcmp(calls, "all") && strcmp(calls, kind)))
        return 0;
    pthread_mutex_lock(&lock);
    int now = --left <= 0, first = now && !struck;
    struck |= now;
    pthread_mutex_unlock(&lock);
    if (first) {
        int (*real_open)(const char *, int, ...) = next("open");
        ssize_t (*real_write)(int, const void *, size_t) = next("write");
        int out = real_open(mark, O_WRONLY | O_CREAT | O_APPEND, 0600);
        if (out >= 0) {
            char text[2 * PATH_MAX + 32];
            int size = snprintf(text, sizeof text, "%s %s\n", kind, path);
            if (real_write(out, text, size) < 0) { }
            close(out);
        }
    }
    if (now) errno = fault;
    return now;
}

static const char *path_of(int descriptor, char *path) {
    char link[64];
    int before = errno;
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t size = readlink(link, path, PATH_MAX - 1);
    errno = before;
    if (size < 0) return NULL;
    path[size] = 0;
    return path;
}

static int descriptor_fails(const char *kind, int descriptor) {
    char path[PATH_MAX];
    return ready && fails(kind, path_of(descriptor, path));
}

/* Of a full disk, of a quota and of a broken one alike: what there was room for is on it. */
static size_t room(size_t size) { return part < (long)size ? (size_t)part : size; }

ssize_t write(int descriptor, const void *data, size_t size) {
    ssize_t (*real)(int, const void *, size_t) = next("write");
    if (!descriptor_fails("write", descriptor)) return real(descriptor, data, size);
    size_t some = room(size);
    if (some == 0) return -1;
    part = 0;
    return real(descriptor, data, some);
}

static ssize_t pwritten(const char *name, int descriptor, const void *data, size_t size, off64_t at) {
    ssize_t (*real)(int, const void *, size_t, off64_t) = next(name);
    if (!descriptor_fails("write", descriptor)) return real(descriptor, data, size, at);
    size_t some = room(size);
    if (some == 0) return -1;
    part = 0;
    return real(descriptor, data, some, at);
}

ssize_t pwrite(int descriptor, const void *data, size_t size, off_t at) {
    return pwritten("pwrite", descriptor, data, size, at);
}

ssize_t pwrite64(int descriptor, const void *data, size_t size, off64_t at) {
    return pwritten("pwrite64", descriptor, data, size, at);
}

int fsync(int descriptor) {
    int (*real)(int) = next("fsync");
    return descriptor_fails("sync", descriptor) ? -1 : real(descriptor);
}

int fdatasync(int descriptor) {
    int (*real)(int) = next("fdatasync");
    return descriptor_fails("sync", descriptor) ? -1 : real(descriptor);
}

int ftruncate(int descriptor, off_t size) {
    int (*real)(int, off_t) = next("ftruncate");
    return descriptor_fails("write", descriptor) ? -1 : real(descriptor, size);
}

int ftruncate64(int descriptor, off64_t size) {
    int (*real)(int, off64_t) = next("ftruncate64");
    return descriptor_fails("write", descriptor) ? -1 : real(descriptor, size);
}

int rename(const char *from, const char *to) {
    int (*real)(const char *, const char *) = next("rename");
    return fails("name", to) ? -1 : real(from, to);
}

int unlink(const char *path) {
    int (*real)(const char *) = next("unlink");
    return fails("name", path) ? -1 : real(path);
}

int fchmod(int descriptor, mode_t mode) {
    int (*real)(int, mode_t) = next("fchmod");
    return descriptor_fails("name", descriptor) ? -1 : real(descriptor, mode);
}

int mkdir(const char *path, mode_t mode) {
    int (*real)(const char *, mode_t) = next("mkdir");
    return fails("make", path) ? -1 : real(path, mode);
}

#define OPENER(name)                                                     \
    int name(const char *path, int flags, ...) {                         \
        int (*real)(const char *, int, ...) = next(#name);               \
        mode_t mode = 0;                                                 \
        if (flags & O_CREAT) {                                           \
            va_list rest;                                                \
            va_start(rest, flags);                                       \
            mode = va_arg(rest, mode_t);                                 \
            va_end(rest);                                                \
            if (fails("make", path)) return -1;                          \
        }                                                                \
        return real(path, flags, mode);                                  \
    }
OPENER(open)
OPENER(open64)
