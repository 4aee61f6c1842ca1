/* A V4L2 camera in user space: preloaded into the client, it answers for one device path.
 *
 * The device file is an eventfd in semaphore mode, whose count is that of the filled buffers: select and poll work on
 * it unchanged. Buffers lie in a memfd, to which mmap of the device is redirected. A thread takes each picture from the
 * memory shared with the simulator (its layout comes generated, ahead of this text) into the oldest queued buffer.
 *
 * LITRIG_SIM_VIDEO names the device path, LITRIG_SIM_FRAMES the shared memory. Without both, every call passes through.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

enum { MAX_BUFFERS = 32, POLL_NS = 500 * 1000 };

struct buffer {
    struct v4l2_buffer info;
    int queued;
};

struct control {
    uint32_t id;
    const char *name;
    uint32_t type;
    int32_t minimum, maximum, step, fallback;
    size_t place;      /* of its value in the shared memory */
    uint32_t auto_id;  /* the control that must be off before this one can be set; 0 for none */
    int32_t auto_off;  /* the value of that control which means off */
};

#define PLACE(field) offsetof(struct shared_frame, field)

static const struct control controls[] = {
    {V4L2_CID_BRIGHTNESS, "Brightness", V4L2_CTRL_TYPE_INTEGER, -64, 64, 1, 0, PLACE(brightness), 0, 0},
    {V4L2_CID_AUTO_WHITE_BALANCE, "White Balance, Automatic", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1, 1,
     PLACE(white_balance_auto), 0, 0},
    {V4L2_CID_GAIN, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 100, 1, 0, PLACE(gain), 0, 0},
    {V4L2_CID_WHITE_BALANCE_TEMPERATURE, "White Balance Temperature", V4L2_CTRL_TYPE_INTEGER, 2800, 6500, 1, 4600,
     PLACE(white_balance_k), V4L2_CID_AUTO_WHITE_BALANCE, 0},
    {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY,
     PLACE(exposure_auto), 0, 0},
    {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 1, 5000, 1, 157,
     PLACE(exposure_100us), V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_FOCUS_ABSOLUTE, "Focus, Absolute", V4L2_CTRL_TYPE_INTEGER, 0, 255, 1, 0, PLACE(focus),
     V4L2_CID_FOCUS_AUTO, 0},
    {V4L2_CID_FOCUS_AUTO, "Focus, Automatic Continuous", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1, 1, PLACE(focus_auto), 0, 0},
};
enum { CONTROLS = sizeof controls / sizeof controls[0] };

static const uint32_t formats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
static const uint32_t sizes[][2] = {{640, 480}, {320, 240}, {800, 600}, {1280, 720}};
enum { FORMATS = 2, SIZES = 4, FASTEST_FPS = 30 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct shared_frame *shared;
static pid_t owner; /* a forked child closes its copies of our files, which must not close the camera */
static int device_fd = -1, lock_fd = -1, memory_fd = -1;
static struct buffer buffers[MAX_BUFFERS];
static uint32_t buffer_count, buffer_bytes;
static uint32_t queue[MAX_BUFFERS], queue_length;  /* waiting for a picture, oldest first */
static uint32_t ready[MAX_BUFFERS], ready_length;  /* filled, oldest first */
static pthread_t thread;
static int thread_runs;
static volatile int thread_stops;

static int (*real_open)(const char *, int, ...);
static int (*real_ioctl)(int, unsigned long, ...);
static void *(*real_mmap)(void *, size_t, int, int, int, off_t);
static int (*real_close)(int);

__attribute__((constructor)) static void find_real_functions(void) {
    real_open = dlsym(RTLD_NEXT, "open");
    real_ioctl = dlsym(RTLD_NEXT, "ioctl");
    real_mmap = dlsym(RTLD_NEXT, "mmap");
    real_close = dlsym(RTLD_NEXT, "close");
}

static int fail(int code) {
    errno = code;
    return -1;
}

static void nap(void) {
    struct timespec time = {0, POLL_NS};
    nanosleep(&time, NULL);
}

static int is_ours(const char *path) {
    const char *device = getenv("LITRIG_SIM_VIDEO");
    return path && device && getenv("LITRIG_SIM_FRAMES") && strcmp(path, device) == 0;
}

static int is_device(int fd) {
    return fd >= 0 && fd == device_fd && getpid() == owner;
}

static int32_t *value_of(const struct control *control) {
    return (int32_t *)((char *)shared + control->place);
}

static const struct control *find_control(uint32_t id) {
    for (int i = 0; i < CONTROLS; i++)
        if (controls[i].id == id) return &controls[i];
    return NULL;
}

/* ---- pictures ---- */

static uint32_t pop(uint32_t *list, uint32_t *length) {
    uint32_t first = list[0];
    memmove(list, list + 1, --*length * sizeof *list);
    return first;
}

static void signal_ready(void) {
    uint64_t one = 1;
    if (write(device_fd, &one, sizeof one) < 0) return; /* the count is full: the client is not listening anyway */
}

/* Copy the newest picture into the oldest queued buffer; nothing happens if it is torn or not of this stream. */
static void take_picture(uint32_t sequence) {
    if (!queue_length) {
        __atomic_add_fetch(&shared->dropped, 1, __ATOMIC_RELAXED);
        return;
    }
    struct buffer *buffer = &buffers[queue[0]];
    uint32_t bytes = shared->picture_bytes;
    if (shared->picture_stream != shared->stream || bytes > buffer_bytes) return;
    char *place = real_mmap(NULL, buffer_bytes, PROT_WRITE, MAP_SHARED, memory_fd, buffer->info.m.offset);
    if (place == MAP_FAILED) return;
    memcpy(place, (char *)shared + HEADER_BYTES, bytes);
    munmap(place, buffer_bytes);
    uint64_t start_ns = shared->exposure_start_ns;
    uint32_t number = shared->number;
    if (__atomic_load_n(&shared->sequence, __ATOMIC_ACQUIRE) != sequence) return;
    buffer->info.bytesused = bytes;
    buffer->info.sequence = number;
    buffer->info.timestamp.tv_sec = start_ns / 1000000000u;
    buffer->info.timestamp.tv_usec = start_ns / 1000u % 1000000u;
    buffer->info.field = V4L2_FIELD_NONE;
    buffer->queued = 0;
    ready[ready_length++] = pop(queue, &queue_length);
    __atomic_add_fetch(&shared->delivered, 1, __ATOMIC_RELAXED);
    signal_ready();
}

static void *deliver(void *unused) {
    (void)unused;
    uint32_t last = __atomic_load_n(&shared->sequence, __ATOMIC_ACQUIRE);
    int woken = 0;
    while (!thread_stops) {
        nap();
        if (shared->hang || shared->unplugged) {
            /* Wake a client that waits in select, so that it finds out in DQBUF. */
            if (!woken) signal_ready();
            woken = 1;
            continue;
        }
        woken = 0;
        uint32_t sequence = __atomic_load_n(&shared->sequence, __ATOMIC_ACQUIRE);
        if (sequence == last || sequence & 1) continue;
        last = sequence;
        pthread_mutex_lock(&lock);
        take_picture(sequence);
        pthread_mutex_unlock(&lock);
    }
    return NULL;
}

static void drain_ready(void) {
    uint64_t one;
    while (read(device_fd, &one, sizeof one) == sizeof one) {}
    ready_length = queue_length = 0;
    for (uint32_t i = 0; i < buffer_count; i++) buffers[i].queued = 0;
}

static int stream_on(void) {
    if (!buffer_count) return fail(EINVAL);
    if (shared->streaming) return 0;
    shared->stream++;
    __atomic_store_n(&shared->streaming, 1, __ATOMIC_RELEASE);
    thread_stops = 0;
    thread_runs = pthread_create(&thread, NULL, deliver, NULL) == 0;
    return thread_runs ? 0 : fail(ENOMEM);
}

/* Called without the lock: the thread may be waiting for it. */
static int stream_off(void) {
    if (thread_runs) {
        thread_stops = 1;
        pthread_join(thread, NULL);
        thread_runs = 0;
    }
    shared->streaming = 0;
    drain_ready();
    return 0;
}

/* ---- opening and closing ---- */

static void set_defaults(void) {
    for (int i = 0; i < CONTROLS; i++) *value_of(&controls[i]) = controls[i].fallback;
    shared->focus = shared->best_focus; /* where autofocus has left it */
    shared->pixel_format = V4L2_PIX_FMT_YUYV;
    shared->width = sizes[0][0];
    shared->height = sizes[0][1];
    shared->fps = FASTEST_FPS;
    shared->streaming = 0;
}

static int attach(void) {
    lock_fd = real_open(getenv("LITRIG_SIM_FRAMES"), O_RDWR | O_CLOEXEC);
    if (lock_fd < 0) return fail(ENODEV); /* the simulator is gone: so is its camera */
    void *memory = real_mmap(NULL, TOTAL_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, lock_fd, 0);
    if (memory == MAP_FAILED) return fail(ENODEV);
    shared = memory;
    if (shared->magic != MAGIC || shared->unplugged) return fail(ENODEV);
    /* The lock goes with the process, also when it is killed. */
    if (flock(lock_fd, LOCK_EX | LOCK_NB)) return fail(EBUSY);
    return 0;
}

static void detach(void) {
    if (shared) munmap(shared, TOTAL_BYTES);
    if (lock_fd >= 0) real_close(lock_fd);
    if (memory_fd >= 0) real_close(memory_fd);
    shared = NULL;
    lock_fd = memory_fd = -1;
    buffer_count = 0;
}

static int open_device(void) {
    if (device_fd >= 0) return fail(EBUSY);
    if (attach()) {
        int code = errno;
        detach();
        return fail(code);
    }
    device_fd = eventfd(0, EFD_SEMAPHORE | EFD_NONBLOCK | EFD_CLOEXEC);
    memory_fd = memfd_create("litrig-sim-buffers", MFD_CLOEXEC);
    set_defaults();
    owner = getpid();
    return device_fd;
}

static int close_device(void) {
    stream_off();
    int fd = device_fd;
    device_fd = -1;
    detach();
    return real_close(fd);
}

/* ---- ioctls ---- */

static uint32_t picture_room(void) {
    return shared->width * shared->height * 2;
}

static void describe_format(struct v4l2_format *format) {
    int compressed = shared->pixel_format == V4L2_PIX_FMT_MJPEG;
    memset(&format->fmt, 0, sizeof format->fmt);
    format->fmt.pix.width = shared->width;
    format->fmt.pix.height = shared->height;
    format->fmt.pix.pixelformat = shared->pixel_format;
    format->fmt.pix.field = V4L2_FIELD_NONE;
    format->fmt.pix.bytesperline = compressed ? 0 : shared->width * 2;
    format->fmt.pix.sizeimage = picture_room();
    format->fmt.pix.colorspace = compressed ? V4L2_COLORSPACE_JPEG : V4L2_COLORSPACE_SRGB;
}

/* Pick what the camera has: an unknown format becomes YUYV, a size the nearest by area. */
static void choose_format(const struct v4l2_format *wanted, uint32_t chosen[3]) {
    double area = (double)wanted->fmt.pix.width * wanted->fmt.pix.height;
    int best = 0;
    for (int i = 1; i < SIZES; i++)
        if (fabs((double)sizes[i][0] * sizes[i][1] - area) < fabs((double)sizes[best][0] * sizes[best][1] - area))
            best = i;
    chosen[0] = sizes[best][0];
    chosen[1] = sizes[best][1];
    chosen[2] = wanted->fmt.pix.pixelformat == V4L2_PIX_FMT_MJPEG ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_YUYV;
}

static int set_format(struct v4l2_format *format, int keep) {
    if (format->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    if (keep && (shared->streaming || buffer_count)) return fail(EBUSY);
    uint32_t chosen[3], before[3] = {shared->width, shared->height, shared->pixel_format};
    choose_format(format, chosen);
    shared->width = chosen[0], shared->height = chosen[1], shared->pixel_format = chosen[2];
    describe_format(format);
    if (!keep) shared->width = before[0], shared->height = before[1], shared->pixel_format = before[2];
    return 0;
}

static int query_capabilities(struct v4l2_capability *capability) {
    memset(capability, 0, sizeof *capability);
    strcpy((char *)capability->driver, "uvcvideo");
    strcpy((char *)capability->card, "litrig simulated camera");
    strcpy((char *)capability->bus_info, "platform:litrig-sim");
    capability->version = 6 << 16;
    capability->device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    capability->capabilities = capability->device_caps | V4L2_CAP_DEVICE_CAPS;
    return 0;
}

static int enumerate_input(struct v4l2_input *input) {
    if (input->index) return fail(EINVAL);
    memset(input, 0, sizeof *input);
    strcpy((char *)input->name, "Camera 1");
    input->type = V4L2_INPUT_TYPE_CAMERA;
    return 0;
}

static int enumerate_format(struct v4l2_fmtdesc *format) {
    if (format->index >= FORMATS || format->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    format->pixelformat = formats[format->index];
    format->flags = format->index ? V4L2_FMT_FLAG_COMPRESSED : 0;
    strcpy((char *)format->description, format->index ? "Motion-JPEG" : "YUYV 4:2:2");
    return 0;
}

static int enumerate_size(struct v4l2_frmsizeenum *size) {
    int known = size->pixel_format == V4L2_PIX_FMT_YUYV || size->pixel_format == V4L2_PIX_FMT_MJPEG;
    if (size->index >= SIZES || !known) return fail(EINVAL);
    size->type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size->discrete.width = sizes[size->index][0];
    size->discrete.height = sizes[size->index][1];
    return 0;
}

static int frame_rate(struct v4l2_streamparm *parameters, int set) {
    if (parameters->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    struct v4l2_fract *time = &parameters->parm.capture.timeperframe;
    if (set && time->numerator && time->denominator) {
        uint32_t fps = time->denominator / time->numerator;
        shared->fps = fps < 1 ? 1 : fps > FASTEST_FPS ? FASTEST_FPS : fps;
    }
    parameters->parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    time->numerator = 1;
    time->denominator = shared->fps;
    return 0;
}

static int request_buffers(struct v4l2_requestbuffers *request) {
    if (request->type != V4L2_BUF_TYPE_VIDEO_CAPTURE || request->memory != V4L2_MEMORY_MMAP) return fail(EINVAL);
    if (shared->streaming) return fail(EBUSY);
    if (request->count > MAX_BUFFERS) request->count = MAX_BUFFERS;
    drain_ready();
    buffer_count = request->count;
    buffer_bytes = (picture_room() + 4095) & ~4095u;
    if (ftruncate(memory_fd, (off_t)buffer_count * buffer_bytes)) return fail(ENOMEM);
    memset(buffers, 0, sizeof buffers);
    for (uint32_t i = 0; i < buffer_count; i++) {
        buffers[i].info.index = i;
        buffers[i].info.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        buffers[i].info.memory = V4L2_MEMORY_MMAP;
        buffers[i].info.length = buffer_bytes;
        buffers[i].info.m.offset = i * buffer_bytes;
    }
    request->capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP;
    return 0;
}

static void show_buffer(struct v4l2_buffer *out, uint32_t index, uint32_t state) {
    *out = buffers[index].info;
    out->flags = state | V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
}

static int query_buffer(struct v4l2_buffer *buffer) {
    if (buffer->index >= buffer_count || buffer->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    show_buffer(buffer, buffer->index, buffers[buffer->index].queued ? V4L2_BUF_FLAG_QUEUED : 0);
    return 0;
}

static int queue_buffer(struct v4l2_buffer *buffer) {
    if (buffer->index >= buffer_count || buffer->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    if (buffer->memory != V4L2_MEMORY_MMAP || buffers[buffer->index].queued) return fail(EINVAL);
    buffers[buffer->index].queued = 1;
    queue[queue_length++] = buffer->index;
    show_buffer(buffer, buffer->index, V4L2_BUF_FLAG_QUEUED);
    return 0;
}

static int dequeue_buffer(struct v4l2_buffer *buffer) {
    if (buffer->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return fail(EINVAL);
    uint64_t one;
    if (!ready_length) {
        while (read(device_fd, &one, sizeof one) == sizeof one) {} /* what only woke the client up */
        return fail(shared->streaming ? EAGAIN : EINVAL);
    }
    if (read(device_fd, &one, sizeof one) < 0) return fail(EAGAIN);
    show_buffer(buffer, pop(ready, &ready_length), V4L2_BUF_FLAG_DONE);
    return 0;
}

static int query_control(struct v4l2_queryctrl *query) {
    const struct control *control = find_control(query->id & ~V4L2_CTRL_FLAG_NEXT_CTRL);
    if (query->id & V4L2_CTRL_FLAG_NEXT_CTRL) {
        uint32_t after = query->id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
        control = NULL;
        for (int i = 0; i < CONTROLS; i++)
            if (controls[i].id > after && (!control || controls[i].id < control->id)) control = &controls[i];
    }
    if (!control) return fail(EINVAL);
    memset(query, 0, sizeof *query);
    query->id = control->id;
    query->type = control->type;
    strcpy((char *)query->name, control->name);
    query->minimum = control->minimum;
    query->maximum = control->maximum;
    query->step = control->step;
    query->default_value = control->fallback;
    const struct control *automatic = find_control(control->auto_id);
    if (automatic && *value_of(automatic) != control->auto_off) query->flags = V4L2_CTRL_FLAG_INACTIVE;
    return 0;
}

static int get_control(struct v4l2_control *wanted) {
    const struct control *control = find_control(wanted->id);
    if (!control) return fail(EINVAL);
    wanted->value = *value_of(control);
    return 0;
}

static int set_control(struct v4l2_control *wanted) {
    const struct control *control = find_control(wanted->id);
    if (!control) return fail(EINVAL);
    int is_exposure_mode = control->id == V4L2_CID_EXPOSURE_AUTO;
    if (is_exposure_mode && wanted->value != V4L2_EXPOSURE_MANUAL && wanted->value != V4L2_EXPOSURE_APERTURE_PRIORITY)
        return fail(EINVAL);
    const struct control *automatic = find_control(control->auto_id);
    if (automatic && *value_of(automatic) != control->auto_off) return fail(EACCES);
    if (wanted->value < control->minimum) wanted->value = control->minimum;
    if (wanted->value > control->maximum) wanted->value = control->maximum;
    *value_of(control) = wanted->value;
    if (control->id == V4L2_CID_FOCUS_AUTO && wanted->value) shared->focus = shared->best_focus;
    return 0;
}

static int answer(uint32_t request, void *argument) {
    switch (request) {
    case (uint32_t)VIDIOC_QUERYCAP: return query_capabilities(argument);
    case (uint32_t)VIDIOC_ENUMINPUT: return enumerate_input(argument);
    case (uint32_t)VIDIOC_G_INPUT: return *(int *)argument = 0;
    case (uint32_t)VIDIOC_S_INPUT: return *(int *)argument ? fail(EINVAL) : 0;
    case (uint32_t)VIDIOC_ENUM_FMT: return enumerate_format(argument);
    case (uint32_t)VIDIOC_ENUM_FRAMESIZES: return enumerate_size(argument);
    case (uint32_t)VIDIOC_G_FMT: describe_format(argument); return 0;
    case (uint32_t)VIDIOC_S_FMT: return set_format(argument, 1);
    case (uint32_t)VIDIOC_TRY_FMT: return set_format(argument, 0);
    case (uint32_t)VIDIOC_G_PARM: return frame_rate(argument, 0);
    case (uint32_t)VIDIOC_S_PARM: return frame_rate(argument, 1);
    case (uint32_t)VIDIOC_REQBUFS: return request_buffers(argument);
    case (uint32_t)VIDIOC_QUERYBUF: return query_buffer(argument);
    case (uint32_t)VIDIOC_QBUF: return queue_buffer(argument);
    case (uint32_t)VIDIOC_DQBUF: return dequeue_buffer(argument);
    case (uint32_t)VIDIOC_STREAMON: return stream_on();
    case (uint32_t)VIDIOC_QUERYCTRL: return query_control(argument);
    case (uint32_t)VIDIOC_G_CTRL: return get_control(argument);
    case (uint32_t)VIDIOC_S_CTRL: return set_control(argument);
    default: return fail(ENOTTY);
    }
}

static int ioctl_device(uint32_t request, void *argument) {
    /* A hanging camera keeps its client in the call; only the switch, or a signal that kills, ends that. */
    while (shared->hang && request == (uint32_t)VIDIOC_DQBUF) nap();
    if (shared->unplugged) return fail(ENODEV);
    if (request == (uint32_t)VIDIOC_STREAMOFF) return stream_off();
    pthread_mutex_lock(&lock);
    int result = answer(request, argument);
    pthread_mutex_unlock(&lock);
    return result;
}

/* ---- what the client calls ---- */

#define OPEN(name, PARAMETERS, MODE)                                                                                  \
    int name PARAMETERS {                                                                                             \
        if (is_ours(path)) return open_device();                                                                      \
        MODE return real_open(path, flags, mode);                                                                     \
    }
#define VARIADIC_MODE                                                                                                 \
    va_list list;                                                                                                     \
    va_start(list, flags);                                                                                            \
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(list, mode_t) : 0;                                           \
    va_end(list);

OPEN(open, (const char *path, int flags, ...), VARIADIC_MODE)
OPEN(open64, (const char *path, int flags, ...), VARIADIC_MODE flags |= O_LARGEFILE;)
OPEN(__open_2, (const char *path, int flags), mode_t mode = 0;)
OPEN(__open64_2, (const char *path, int flags), mode_t mode = 0; flags |= O_LARGEFILE;)

int ioctl(int fd, unsigned long request, ...) {
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    if (is_device(fd)) return ioctl_device((uint32_t)request, argument);
    return real_ioctl(fd, request, argument);
}

void *mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset) {
    if (!real_mmap) find_real_functions(); /* an allocator may come before our constructor */
    if (is_device(fd)) fd = memory_fd;
    return real_mmap(address, length, protection, flags, fd, offset);
}

void *mmap64(void *address, size_t length, int protection, int flags, int fd, off_t offset) {
    return mmap(address, length, protection, flags, fd, offset);
}

int close(int fd) {
    if (!real_close) find_real_functions();
    if (is_device(fd)) return close_device();
    return real_close(fd);
}
