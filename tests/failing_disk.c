/* Makes a disk fail: loaded before a program's own libc, by LD_PRELOAD.
 *
 * FAIL_BELOW is a folder, FAIL_WITH an errno, FAIL_AFTER the number of calls below the folder that
 * still succeed, of all processes together, which count in the file FAIL_COUNT. FAIL_TIMES is how
 * many fail then, -1 for all.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static int below(const char *path) {
  const char *folder = getenv("FAIL_BELOW");
  size_t length = folder ? strlen(folder) : 0;
  return length && strncmp(path, folder, length) == 0 && (path[length] == '/' || !path[length]);
}

static int fails(void) {
  static volatile int *count;
  if (!count) {
    int file = REAL(open)(getenv("FAIL_COUNT"), O_RDWR);
    if (file < 0) return 0;
    count = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (count == MAP_FAILED) abort();
  }
  int number = __sync_fetch_and_add(count, 1) - atoi(getenv("FAIL_AFTER"));
  int times = atoi(getenv("FAIL_TIMES"));
  if (number < 0 || (times >= 0 && number >= times)) return 0;
  errno = atoi(getenv("FAIL_WITH"));
  return 1;
}

static int path_fails(const char *path) {
  char whole[PATH_MAX];
  if (path[0] != '/') {
    if (!getcwd(whole, sizeof whole / 2)) return 0;
    strcat(whole, "/");
    strncat(whole, path, sizeof whole / 2 - 2);
    path = whole;
  }
  return below(path) && fails();
}

static int file_fails(int file) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = 0;
  return below(path) && fails();
}

#define OPENS(name)                                                       \
  int name(const char *path, int flags, ...) {                            \
    va_list more;                                                         \
    va_start(more, flags);                                                \
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, int) : 0;  \
    va_end(more);                                                         \
    if ((flags & O_CREAT) && path_fails(path)) return -1;                 \
    return REAL(name)(path, flags, mode);                                 \
  }
OPENS(open)
OPENS(open64)

#define WRITES(name, ...)                              \
  if (file_fails(file)) return -1;                     \
  return REAL(name)(file __VA_OPT__(, ) __VA_ARGS__)
ssize_t write(int file, const void *bytes, size_t count) { WRITES(write, bytes, count); }
ssize_t pwrite(int file, const void *bytes, size_t count, off_t at) {
  WRITES(pwrite, bytes, count, at);
}
ssize_t pwrite64(int file, const void *bytes, size_t count, off64_t at) {
  WRITES(pwrite64, bytes, count, at);
}
int fsync(int file) { WRITES(fsync); }
int fdatasync(int file) { WRITES(fdatasync); }
int ftruncate(int file, off_t length) { WRITES(ftruncate, length); }
int ftruncate64(int file, off64_t length) { WRITES(ftruncate64, length); }
int mkdir(const char *path, mode_t mode) {
  return path_fails(path) ? -1 : REAL(mkdir)(path, mode);
}
int rename(const char *from, const char *to) {
  return path_fails(to) ? -1 : REAL(rename)(from, to);
}
int link(const char *from, const char *to) { return path_fails(to) ? -1 : REAL(link)(from, to); }
