/* SPDX-License-Identifier: MIT */
/*
 * The library alone, without GStreamer: raw I420 frames from stdin, stabilized ones to stdout.
 *
 *     stabilize-raw WIDTH HEIGHT [FRAMES_PER_SECOND]
 *
 *     ffmpeg -i in.mp4 -f rawvideo -pix_fmt yuv420p - | stabilize-raw 1280 720 30 |
 *         ffmpeg -f rawvideo -pix_fmt yuv420p -s 1280x720 -r 30 -i - out.mp4
 */
#include <l1l2stab/l1l2stab.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct Size {
    int width, height; /* pixels */
} Size;

static size_t frame_bytes(Size size)
{
    const size_t luma = (size_t)size.width * (size_t)size.height;
    const size_t chroma = (size_t)((size.width + 1) / 2) * (size_t)((size.height + 1) / 2);
    return luma + 2 * chroma;
}

/* The three planes of an I420 picture in one piece of memory. */
static void set_planes(L1L2StabFrame *frame, uint8_t *memory, Size size)
{
    const ptrdiff_t chroma_stride = (size.width + 1) / 2;
    frame->stride[0] = size.width;
    frame->stride[1] = frame->stride[2] = chroma_stride;
    frame->data[0] = memory;
    frame->data[1] = frame->data[0] + (ptrdiff_t)size.width * size.height;
    frame->data[2] = frame->data[1] + chroma_stride * ((size.height + 1) / 2);
}

/* The library holds a window of frames, so each gets memory of its own, which release frees. 0: no more frames. */
static int read_frame(L1L2StabFrame *in, Size size)
{
    const size_t bytes = frame_bytes(size);
    uint8_t *memory = malloc(bytes);
    if (!memory || fread(memory, 1, bytes, stdin) != bytes) {
        free(memory);
        return 0;
    }
    set_planes(in, memory, size);
    in->opaque = memory;
    in->release = free;
    return 1;
}

static void log_line(void *cookie, L1L2StabLogLevel level, const char *message)
{
    (void)cookie, (void)level;
    fprintf(stderr, "l1l2stab: %s\n", message);
}

/* The loop of l1l2stab.h. OK when all went well. After an error the frames that are held still come out. */
static L1L2StabResult stabilize(L1L2Stab *s, Size size, uint8_t *memory)
{
    L1L2StabFrame in = {0}, out = {0};
    L1L2StabResult r = L1L2STAB_OK;

    set_planes(&out, memory, size);
    while (read_frame(&in, size)) {
        if ((r = l1l2stab_push(s, &in)) != L1L2STAB_OK) {
            free(in.opaque);
            break;
        }
        while ((r = l1l2stab_pull(s, &out, NULL)) == L1L2STAB_OK)
            fwrite(memory, 1, frame_bytes(size), stdout);
    }
    l1l2stab_finish(s);
    while (l1l2stab_pull(s, &out, NULL) == L1L2STAB_OK)
        fwrite(memory, 1, frame_bytes(size), stdout);
    return r < 0 ? r : l1l2stab_take_error(s);
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc > 4) {
        fprintf(stderr, "usage: stabilize-raw WIDTH HEIGHT [FRAMES_PER_SECOND] <in.yuv >out.yuv     (I420)\n");
        return 2;
    }
    const Size size = {atoi(argv[1]), atoi(argv[2])};

    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = size.width;
    cfg.height = size.height;
    cfg.frame_rate = argc > 3 ? atof(argv[3]) : 0;
    cfg.logger.write = log_line;
    cfg.logger.max_level = L1L2STAB_LOG_WARN;

    L1L2Stab *s = NULL;
    L1L2StabResult r = l1l2stab_create(&s, &cfg);
    uint8_t *memory = r == L1L2STAB_OK ? malloc(frame_bytes(size)) : NULL;
    if (memory)
        r = stabilize(s, size, memory);
    else if (r == L1L2STAB_OK)
        r = L1L2STAB_ERR_NOMEM;
    free(memory);
    l1l2stab_free(&s);

    if (r != L1L2STAB_OK) {
        fprintf(stderr, "stabilize-raw: %s\n", l1l2stab_strerror(r));
        return 1;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        perror("stabilize-raw: stdout");
        return 1;
    }
    return 0;
}
