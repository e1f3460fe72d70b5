/* SPDX-License-Identifier: MIT */
/*
 * l1l2stab: one-pass video stabilization with L1-L2 optimal camera paths.
 *
 * Source: Qu & Song, "Video stabilization with L1-L2 optimization", ICIP 2013. Equation numbers are that paper's.
 *
 * Conventions
 *   Frames       t = 0, 1, 2, ... in the order of l1l2stab_push().
 *   Coordinates  pixels, origin at the frame's center, x right, y down. Pixel centers lie at half-integers: the
 *                frame is exactly [-W/2, W/2] x [-H/2, H/2].
 *   Pixel aspect F, B, S, C and P, and given motions, are in square pixels of the picture as it is shown: there the
 *                frame is pixel_aspect W wide and H high, since a roll is a rotation in that picture alone. Only
 *                `warp` in L1L2StabInfo is in samples. With pixel_aspect 1 the two are the same.
 *   Matrices     3x3, row-major, act on column vectors (x, y, 1).
 *   Directions   F_t maps frame t to frame t-1; C_t = F_1 ... F_t (eq. 1); P_t = C_t B_t (eq. 2);
 *                B_t maps the crop window to the source frame: it is the inverse map that a warp wants.
 *   Strides      bytes.
 *   Times        nanoseconds.
 *
 * Delay
 *   One frame in, one frame out, in order. Frame t can be pulled once frame t + window - 1 has been pushed, or after
 *   l1l2stab_finish(). The library holds at most `window` frames. l1l2stab_hurry() lets frames go sooner.
 *
 * Threads
 *   Calls on one L1L2Stab must not overlap; they may come from different threads one after the other. Different
 *   instances are independent: there is no global state. The same frames and config give the same output, bit for bit,
 *   whatever `threads` is.
 *
 * Errors
 *   A call that returns an error < 0 has changed nothing, and the stream can go on. The motion of a frame may be
 *   measured after push() has returned. So if that fails (no memory), no call returns the error. Instead a path starts
 *   at that frame, L1L2STAB_INFO_MOTION_FAILED marks it, and l1l2stab_take_error() returns the error. No frame is lost.
 *
 * Growth
 *   L1L2StabConfig and L1L2StabFrame grow at their ends and carry their size; L1L2StabInfo grows into its reserved
 *   bytes. A program built against an older header of the same soname runs unchanged. While the major version is 0 the
 *   soname is "0.MINOR": another minor version may break programs, and then has another soname.
 *
 * The loop (samples/1-stabilize-raw.c runs it)
 *
 *     L1L2StabResult r = L1L2STAB_OK;
 *     while (read_frame(&in)) {
 *         if ((r = l1l2stab_push(s, &in)) != L1L2STAB_OK) {
 *             drop_frame(&in);                          // still the caller's
 *             break;
 *         }
 *         while ((r = l1l2stab_pull(s, &out, NULL)) == L1L2STAB_OK)
 *             write_frame(&out);                        // ends with L1L2STAB_AGAIN
 *     }
 *     l1l2stab_finish(s);                               // also after an error: what is held can still be pulled
 *     while (l1l2stab_pull(s, &out, NULL) == L1L2STAB_OK)
 *         write_frame(&out);                            // ends with L1L2STAB_EOS
 */
#ifndef L1L2STAB_H
#define L1L2STAB_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define L1L2STAB_API __attribute__((visibility("default")))
#define L1L2STAB_MUST_CHECK __attribute__((warn_unused_result))
#else
#define L1L2STAB_API
#define L1L2STAB_MUST_CHECK
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this header; l1l2stab_version() returns that of the library. meson.build reads these three. */
#define L1L2STAB_VERSION_MAJOR 0
#define L1L2STAB_VERSION_MINOR 2
#define L1L2STAB_VERSION_PATCH 0

typedef struct L1L2Stab L1L2Stab;

/* >= 0: flow states, < 0: errors. */
typedef enum L1L2StabResult {
    L1L2STAB_OK = 0,
    L1L2STAB_AGAIN = 1,            /* pull: push more first; push: pull first */
    L1L2STAB_EOS = 2,              /* finished, and every frame has been pulled */
    L1L2STAB_ERR_ARGUMENT = -1,    /* the caller's fault: a value out of range, a NULL; the log says which */
    L1L2STAB_ERR_STATE = -2,       /* the caller's fault: a call out of order, such as push after finish */
    L1L2STAB_ERR_UNSUPPORTED = -3, /* valid, but not supported; the log says what is supported */
    L1L2STAB_ERR_NOMEM = -4,       /* the system is out of memory */
    L1L2STAB_ERR_BACKEND = -5      /* the library's fault: OpenCV or the solver failed, and there is no fallback */
} L1L2StabResult;

/* Names, order of planes and layout are GStreamer's. For odd frame sizes the sizes of chroma planes are rounded up, and
 * packed 4:2:2 rows are rounded up to pairs of pixels. Alpha, and the byte that X stands for, is warped like a color.
 * 10, 12 and 16 are the bits of a component. Such a component takes two bytes, the low one first; addresses of planes
 * and strides must be even. These formats are not supported on big-endian processors. */
typedef enum L1L2StabFormat {
    L1L2STAB_FORMAT_UNKNOWN = 0,
    L1L2STAB_FORMAT_GRAY8 = 1,
    L1L2STAB_FORMAT_I420 = 2, /* Y, U, V; chroma halved both ways */
    L1L2STAB_FORMAT_YV12 = 3, /* Y, V, U; chroma halved both ways */
    L1L2STAB_FORMAT_NV12 = 4, /* Y, UV interleaved; chroma halved both ways */
    L1L2STAB_FORMAT_NV21 = 5, /* Y, VU interleaved; chroma halved both ways */
    L1L2STAB_FORMAT_Y42B = 6, /* Y, U, V; chroma halved horizontally */
    L1L2STAB_FORMAT_Y444 = 7, /* Y, U, V */
    L1L2STAB_FORMAT_BGRX = 8, /* one plane, 4 bytes a pixel in this order; X is undefined */
    L1L2STAB_FORMAT_RGBX = 9,
    L1L2STAB_FORMAT_BGRA = 10,
    L1L2STAB_FORMAT_RGBA = 11,
    L1L2STAB_FORMAT_BGR = 12, /* one plane, 3 bytes a pixel in this order */
    L1L2STAB_FORMAT_RGB = 13,
    L1L2STAB_FORMAT_A420 = 14, /* I420 and alpha */
    L1L2STAB_FORMAT_AV12 = 15, /* NV12 and alpha */
    L1L2STAB_FORMAT_NV16 = 16, /* Y, UV interleaved; chroma halved horizontally */
    L1L2STAB_FORMAT_NV61 = 17, /* Y, VU interleaved; chroma halved horizontally */
    L1L2STAB_FORMAT_NV24 = 18, /* Y, UV interleaved */
    L1L2STAB_FORMAT_Y41B = 19, /* Y, U, V; chroma quartered horizontally */
    L1L2STAB_FORMAT_XRGB = 20, /* one plane, 4 bytes a pixel in this order; X is undefined */
    L1L2STAB_FORMAT_XBGR = 21,
    L1L2STAB_FORMAT_ARGB = 22,
    L1L2STAB_FORMAT_ABGR = 23,
    L1L2STAB_FORMAT_AYUV = 24,
    L1L2STAB_FORMAT_VUYA = 25,
    L1L2STAB_FORMAT_GBR = 26,  /* G, B, R */
    L1L2STAB_FORMAT_GBRA = 27, /* G, B, R, A */
    L1L2STAB_FORMAT_YUY2 = 28, /* packed 4:2:2: one plane, two pixels in 4 bytes: Y U Y V */
    L1L2STAB_FORMAT_UYVY = 29, /* U Y V Y */
    L1L2STAB_FORMAT_YVYU = 30, /* Y V Y U */
    L1L2STAB_FORMAT_VYUY = 31, /* V Y U Y */
    L1L2STAB_FORMAT_GRAY16_LE = 32,
    L1L2STAB_FORMAT_I420_10LE = 33,
    L1L2STAB_FORMAT_I420_12LE = 34,
    L1L2STAB_FORMAT_I422_10LE = 35, /* Y, U, V; chroma halved horizontally */
    L1L2STAB_FORMAT_I422_12LE = 36,
    L1L2STAB_FORMAT_Y444_10LE = 37,
    L1L2STAB_FORMAT_Y444_12LE = 38,
    L1L2STAB_FORMAT_Y444_16LE = 39,
    L1L2STAB_FORMAT_A420_10LE = 40,
    L1L2STAB_FORMAT_A422_10LE = 41,
    L1L2STAB_FORMAT_A444_10LE = 42,
    L1L2STAB_FORMAT_GBR_10LE = 43,
    L1L2STAB_FORMAT_GBR_12LE = 44,
    L1L2STAB_FORMAT_GBRA_10LE = 45,
    L1L2STAB_FORMAT_GBRA_12LE = 46,
    L1L2STAB_FORMAT_P010_10LE = 47, /* as NV12, in the upper bits of two bytes; the lower ones are zero */
    L1L2STAB_FORMAT_P012_LE = 48,
    L1L2STAB_FORMAT_P016_LE = 49,
    L1L2STAB_FORMAT_ARGB64_LE = 50, /* one plane, 4 components of 16 bits a pixel in this order */
    L1L2STAB_FORMAT_RGBA64_LE = 51,
    L1L2STAB_FORMAT_BGRA64_LE = 52,
    L1L2STAB_FORMAT_ABGR64_LE = 53,
    L1L2STAB_FORMAT_AYUV64 = 54
} L1L2StabFormat;

/* Where a chroma sample lies within the luma samples that share it. It matters in subsampled directions only. */
typedef enum L1L2StabChromaSite {
    L1L2STAB_CHROMA_SITE_LEFT = 0,    /* on the left column, between the rows (MPEG-2, H.264, HEVC): the default */
    L1L2STAB_CHROMA_SITE_CENTER = 1,  /* between columns and rows (JPEG, MPEG-1) */
    L1L2STAB_CHROMA_SITE_TOP_LEFT = 2 /* on the left column and the top row (BT.2020 UHD) */
} L1L2StabChromaSite;

/* How the paths of two windows are joined (paper, section 4.1). */
typedef enum L1L2StabJoin {
    L1L2STAB_JOIN_CONTINUOUS = 0, /* the next window continues from the last three emitted frames: no seam */
    L1L2STAB_JOIN_BLEND = 1       /* eq. (8), weights corrected: the overlap is averaged */
} L1L2StabJoin;

/* The model of F_t, and with it of the camera path. */
typedef enum L1L2StabMotionModel {
    L1L2STAB_MOTION_MODEL_TRANSLATION = 0, /* 2 parameters: move; the picture is never turned or zoomed */
    L1L2STAB_MOTION_MODEL_SIMILARITY = 1,  /* 4: move, turn, zoom */
    L1L2STAB_MOTION_MODEL_AFFINE = 2       /* 6: also shear and zoom along one axis */
} L1L2StabMotionModel;

/* How the rolling-shutter residual is removed: the motion that a similarity leaves (paper, Algorithm 1, step 4). */
typedef enum L1L2StabRollingShutter {
    L1L2STAB_ROLLING_SHUTTER_NONE = 0,
    L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY = 1, /* one homography a frame */
    L1L2STAB_ROLLING_SHUTTER_MIXTURE = 2     /* a homography for each row, and the skew that the camera's speed makes */
} L1L2StabRollingShutter;

typedef enum L1L2StabInterpolation {
    L1L2STAB_INTERPOLATION_BILINEAR = 0, /* 2x2 taps: fast and soft; sharpness varies with the subpixel position */
    L1L2STAB_INTERPOLATION_BICUBIC = 1,  /* 4x4 taps, a = -0.75 */
    L1L2STAB_INTERPOLATION_LANCZOS = 2   /* 6x6 taps, three lobes */
} L1L2StabInterpolation;

typedef enum L1L2StabOutputSize {
    L1L2STAB_OUTPUT_SIZE_INPUT = 0, /* the crop window is zoomed to fill the input's size */
    L1L2STAB_OUTPUT_SIZE_CROP = 1   /* the crop window's own size, rounded down to even numbers: no zoom */
} L1L2StabOutputSize;

/* What is shown where the stabilized frame reaches beyond the source frame. */
typedef enum L1L2StabBorder {
    L1L2STAB_BORDER_CROP = 0,  /* it does not: what is shown is the crop window, zoomed to the output's size */
    L1L2STAB_BORDER_FILL = 1,  /* the whole frame is shown at its own scale, and neighboring frames fill what it lacks.
                                * What no neighbor shows is extended. crop_ratio says how much room the path has;
                                * frames of which too much would be extended get less */
    L1L2STAB_BORDER_EXTEND = 2 /* the same without neighbors: the frame is mirrored at its sides, and softened */
} L1L2StabBorder;

/* Which solver solves eq. (4): for tests and measurements. */
typedef enum L1L2StabSolver {
    L1L2STAB_SOLVER_AUTO = 0,      /* the predictor; OSQP checks it where a window emits 8 frames or more */
    L1L2STAB_SOLVER_CHECKED = 1,   /* the predictor, always checked by OSQP */
    L1L2STAB_SOLVER_PREDICTOR = 2, /* the predictor; OSQP only where it does not converge */
    L1L2STAB_SOLVER_OSQP = 3       /* OSQP alone: much slower, and less exact */
} L1L2StabSolver;

typedef enum L1L2StabLogLevel {
    L1L2STAB_LOG_ERROR = 1, /* an error that this call returns, or that l1l2stab_take_error() will return */
    L1L2STAB_LOG_WARN = 2,  /* output quality suffers */
    L1L2STAB_LOG_INFO = 3,  /* once per instance */
    L1L2STAB_LOG_DEBUG = 4, /* once per event */
    L1L2STAB_LOG_TRACE = 5  /* once per frame */
} L1L2StabLogLevel;

/* This struct does not grow, because it lies within the config. New settings of the log go to the config's end. */
typedef struct L1L2StabLogger {
    /* Called with a finished message without newline, on the thread of the call that logs. Must not call the library
     * with the same instance. NULL: silent. */
    void (*write)(void *cookie, L1L2StabLogLevel level, const char *message);
    void *cookie;               /* passed to write; must live as long as the instance */
    L1L2StabLogLevel max_level; /* more verbose messages are not even formatted; default L1L2STAB_LOG_INFO */
} L1L2StabLogger;

/* Initialize it with l1l2stab_config_init(), then set format, width, height, and each field that is to differ from its
 * default. To add a field, append it here and extend l1l2stab_config_init() and the checks in config.c. */
typedef struct L1L2StabConfig {
    size_t struct_size;            /* bytes; set by l1l2stab_config_init() */
    L1L2StabFormat format;         /* required */
    int width;                     /* pixels, [16, 16384], required */
    int height;                    /* pixels, [16, 16384], required */
    double frame_rate;             /* frames a second, [0, 1000]; 0 = unknown, taken as 30. Default 0 */
    L1L2StabChromaSite chroma_site; /* default LEFT */
    double lambda;                 /* eq. (4), [0, 1000], default 0.5: 0.1 is nearly pure L1, 2 follows the shake */
    double crop_ratio;             /* kept part of each side, [0.5, 0.99], default 0.9 */
    int window;                    /* N, frames, [4, 900], default 150: the look-ahead and the delay */
    int overlap;                   /* K, frames, [3, window), for BLEND 2K <= window; 0 = chosen by join. Default 0 */
    L1L2StabJoin join;             /* default CONTINUOUS */
    L1L2StabInterpolation interpolation; /* default BICUBIC */
    L1L2StabOutputSize output_size; /* default INPUT */
    int analysis_size;             /* longer side of the picture that is tracked, pixels, [128, 4096], default 640 */
    int threads;                   /* including the caller's, [0, 64]; 0 = one per core. Default 0 */
    uint64_t seed;                 /* of RANSAC's random samples. Default 1 */
    L1L2StabLogger logger;         /* default: silent */
    double weights[3];             /* of |DP|, |D2P|, |D3P|, (0, 1000]; default 1, 1, 1 (eq. 5); G2011 has 10, 1, 100 */
    L1L2StabSolver solver;         /* default AUTO */
    L1L2StabMotionModel motion_model; /* default SIMILARITY */
    L1L2StabRollingShutter rolling_shutter; /* default MIXTURE */
    double pixel_aspect;           /* a pixel's width by its height as it is shown, [0.1, 10], default 1 */
    /* What is measured: the camera's motion is taken from the region, without what the mask excludes. The whole picture
     * is still stabilized, and cuts and dissolves are still found in the whole picture. At least 1 % of the frame has
     * to be left; only what is left decides, so it should show the background. */
    double region[4];              /* x, y, width, height: of the part that is measured, in parts of the frame's width
                                    * and height. Within the frame, at least 1/8 wide and high; default 0, 0, 1, 1 */
    const uint8_t *mask;           /* scaled to the frame; 0: not measured there, any other value: measured. Read during
                                    * l1l2stab_create() only. NULL: no mask, the default */
    ptrdiff_t mask_stride;         /* bytes from a row to the next, at least mask_width; of the mask, if there is one */
    int mask_width, mask_height;   /* pixels, [1, 16384]; ditto. Any size and aspect: it covers the whole frame */
    L1L2StabBorder border;         /* default CROP. FILL and EXTEND need output_size INPUT */
    int fill_frames;               /* with FILL: neighbors are at most so many frames away, either way, [0, 120],
                                    * default 30. So many frames are kept after they have been pulled */
} L1L2StabConfig;

/* A new path starts at this frame: no frame before it belongs to the same shot. */
#define L1L2STAB_FRAME_DISCONT (1u << 0)

/* The pts of a frame that has no timestamp. */
#define L1L2STAB_NO_PTS INT64_MIN

/* A frame: to push(), the picture to stabilize; to pull(), the memory to render into. Clear it to zero and set what is
 * needed. Fields are only ever added at the end. */
typedef struct L1L2StabFrame {
    /* sizeof(L1L2StabFrame), or 0 for the layout of version 0.2 (up to and including `motion`), so that a frame cleared
     * to zero is valid. If it is larger than the library's own struct, the additional bytes must be 0. */
    size_t struct_size;
    uint8_t *data[4];    /* first row of each plane; push() only reads, pull() only writes; unused ones are ignored */
    ptrdiff_t stride[4]; /* bytes from a row to the next, may be negative */
    /* The frame's time in nanoseconds, or L1L2STAB_NO_PTS; pull() returns it with the same frame. Where the frames are
     * not evenly spaced, the path is smooth in time. A step that is within 2 ms of 1 / frame_rate, shorter than 1 ms,
     * or without two timestamps counts as one frame, and so does every step where frame_rate is 0. Any other counts by
     * its length, but as 1/4 frame at least and as 4 frames at most. So numbers that are not times, such as 0, 1, 2,
     * have no effect. A step back counts as one frame; where timestamps keep falling (reverse playback), by its
     * length. */
    int64_t pts;
    void *opaque;        /* the caller's; pull() returns it with the same frame */
    /* push() only: called exactly once, by the pull, reset or free that no longer needs the pixels. With
     * L1L2STAB_BORDER_FILL that is `fill_frames` pulls later, or at the end of the stream. Never called if push() did
     * not return OK. Must not call the library with this instance. May be NULL. */
    void (*release)(void *opaque);
    unsigned flags;      /* push() only: L1L2STAB_FRAME_* */
    /* push() only: the frame's F_t, where the caller knows it; NULL: it is measured. Nine numbers as at the top of this
     * file, in pixels, read during the call: a map of motion_model that is not mirrored, moves the frame's center by at
     * most 10 diagonals, and stretches no direction by more than 2 or less than 1/2. A path's first frame has no
     * motion: there it is checked and not used. With a motion, data may be NULL; the frame can then only be pulled
     * with out = NULL. */
    const double *motion;
} L1L2StabFrame;

/* Where a frame's motion F_t came from. The measured ones come last, in the order of L1L2StabMotionModel. */
typedef enum L1L2StabMotionSource {
    L1L2STAB_MOTION_SOURCE_NONE = 0,        /* a path's first frame: there is no motion */
    L1L2STAB_MOTION_SOURCE_IDENTITY = 1,    /* nothing could be measured: the camera is taken as still */
    L1L2STAB_MOTION_SOURCE_PREDICTED = 2,   /* nothing could be measured: the last motion is continued and decays */
    L1L2STAB_MOTION_SOURCE_GIVEN = 3,       /* from the caller: L1L2StabFrame.motion */
    L1L2STAB_MOTION_SOURCE_TRANSLATION = 4, /* measured; too few points for more parameters */
    L1L2STAB_MOTION_SOURCE_SIMILARITY = 5,  /* measured */
    L1L2STAB_MOTION_SOURCE_AFFINE = 6,      /* measured */
    L1L2STAB_MOTION_SOURCE_ALIGNMENT = 7    /* measured from whole pictures, where the tracks did not yield a motion */
} L1L2StabMotionSource;

#define L1L2STAB_INFO_PATH_START (1u << 0)    /* first frame of a path */
#define L1L2STAB_INFO_MOTION_LOST (1u << 1)   /* the motion into this frame was not measured */
#define L1L2STAB_INFO_PATH_FALLBACK (1u << 2) /* the solver did not converge: a feasible path was held instead */
#define L1L2STAB_INFO_EARLY (1u << 3)         /* l1l2stab_hurry() decided the frame: its look-ahead was shorter */
#define L1L2STAB_INFO_MOTION_FAILED (1u << 4) /* measuring met an error (l1l2stab_take_error()): a path starts here */
#define L1L2STAB_INFO_BRIDGED (1u << 5)       /* F was changed by aligning pictures across frames that have no tracks */

/* The stages that a frame's time is spent in. */
typedef enum L1L2StabStage {
    L1L2STAB_STAGE_SCALE = 0, /* scaling to the analyzed size, pyramid */
    L1L2STAB_STAGE_TRACK = 1, /* corners and Lucas-Kanade */
    L1L2STAB_STAGE_FIT = 2,   /* RANSAC and least squares */
    L1L2STAB_STAGE_SOLVE = 3, /* eq. (4); counted on the oldest held frame when a window is solved */
    L1L2STAB_STAGE_WARP = 4,
    L1L2STAB_STAGE_COUNT = 5  /* stages so far; a later version may add some, up to 8 */
} L1L2StabStage;

/* The measurements of a frame, and what was done to it. pull() overwrites the whole struct, so it needs no
 * initialization. Matrices as at the top of this file, in pixels. */
typedef struct L1L2StabInfo {
    uint64_t index;      /* the frame's number since create or reset, from 0 */
    uint64_t path_index; /* the frame's number in its path, from 0 */
    double F[9];         /* motion, frame t to frame t-1, that the path is made of; identity at a path's first frame.
                          * Given as L1L2StabFrame.motion in another run, it makes the same path, bit for bit. */
    double B[9];         /* update transform: crop window to frame t */
    double S[9];         /* smooth step P_{t-1}^-1 P_t: the motion that is left; identity at a path's first frame */
    double C[9];         /* camera path, for display: accumulated from F, relative to the path's first frame. Always
                          * finite: beyond a million diagonals or a zoom of a million it starts again at this frame. */
    double P[9];         /* smoothed path C B, for display */
    double warp[9];      /* output pixel to source pixel, origins at the centers: what was rendered. In samples,
                          * also where pixels are not square */
    double lambda;       /* value that this frame was pushed with */
    double crop_ratio;   /* value in effect for this frame; after a change it ramps to the new setting */
    int tracks;          /* points that were tracked into this frame and passed the backward check */
    int inliers;         /* of these, points that agree with F */
    int solver_iterations; /* of the window that this frame came from */
    L1L2StabMotionSource model; /* where F came from */
    unsigned flags;      /* L1L2STAB_INFO_* */
    int64_t stage_ns[8]; /* time spent, by L1L2StabStage; the rest is 0 */
    /* Of the window that this frame came from: */
    L1L2StabSolver solver;  /* which solver decided: PREDICTOR, OSQP, or CHECKED where both agree */
    double solver_bound;    /* the objective is at most this far above its optimum; infinite for OSQP alone */
    double solver_residual[2]; /* OSQP's primal and dual residual; 0 where it did not run */
    double quality;          /* of F, [0, 1]: 0 not measured, 1 where points all over the frame agree */
    double bypass;           /* of what was rendered, [0, 1]: 0 stabilized, 1 untouched */
    double residual;         /* rolling-shutter correction: the longest distance by which it moved a sample, pixels */
    double readout;          /* time from the first row to the last, frames, as estimated; < 0: bottom row first;
                              * 0: not known */
    double filled;           /* with L1L2STAB_BORDER_FILL: the part of the output that neighbors gave, [0, 1] */
    double extended;         /* with FILL and EXTEND: the part that no frame shows and that was extended, [0, 1] */
    uint8_t reserved[240];   /* 0; later versions put further fields here and keep the struct's size */
} L1L2StabInfo;

/* Fills *cfg with the defaults. Pass sizeof *cfg, so that a program built against an older header still works. */
L1L2STAB_API void l1l2stab_config_init(L1L2StabConfig *cfg, size_t struct_size);

/* The delay that this config implies, in frames: its window. An error < 0 if the config is not valid. */
L1L2STAB_API int l1l2stab_config_delay(const L1L2StabConfig *cfg);

/* The size in pixels of what pull() writes. An error if the config is not valid; then *width and *height are 0. */
L1L2STAB_API L1L2StabResult l1l2stab_config_output_size(const L1L2StabConfig *cfg, int *width, int *height);

/* Creates an instance; free it with l1l2stab_free(). cfg need only live during the call, the logger's cookie as long as
 * the instance. On error *out is NULL and the reason has been logged. */
L1L2STAB_API L1L2STAB_MUST_CHECK L1L2StabResult l1l2stab_create(L1L2Stab **out, const L1L2StabConfig *cfg);

/* Hands over the next frame. Its motion is measured; with `threads` > 1 this goes on after the call, so that tracking
 * this frame and rendering the one that is pulled next overlap.
 * OK: the library reads in->data until it calls in->release. AGAIN: `window` frames are held, pull first.
 * Anything but OK: the frame remains the caller's, and the stream is as if it had not been pushed. */
L1L2STAB_API L1L2STAB_MUST_CHECK L1L2StabResult l1l2stab_push(L1L2Stab *s, const L1L2StabFrame *in);

/* Returns the first error of measuring a frame since the last call of this function: ERR_NOMEM or ERR_BACKEND, or OK if
 * there was none. push() had accepted that frame, and it is not lost: a path starts there, and its info has
 * L1L2STAB_INFO_MOTION_FAILED. Does not wait: the error of the newest frame is known after the next push() or
 * finish(). reset() forgets the error. */
L1L2STAB_API L1L2StabResult l1l2stab_take_error(L1L2Stab *s);

/* Set lambda and crop_ratio of the frames that are pushed from now on, also after a reset(); ranges as in the config.
 * The crop ratio changes by at most 0.005 a frame, so that the picture does not jump; a path that starts has the new
 * one at once. With output_size CROP the output keeps the size that the config gave it. */
L1L2STAB_API L1L2StabResult l1l2stab_set_lambda(L1L2Stab *s, double lambda);
L1L2STAB_API L1L2StabResult l1l2stab_set_crop_ratio(L1L2Stab *s, double crop_ratio);

/* bypass != 0: the frames that are pulled from now on are not stabilized; 0: they are again. Frames that are held
 * already are included, so the change has no delay. The picture changes over L1L2STAB_BYPASS_FRAMES frames, or at once
 * where a path starts, and stays inside the source meanwhile. The path is computed during the bypass too. A bypassed
 * picture is the whole frame, or with output_size CROP its middle. */
#define L1L2STAB_BYPASS_FRAMES 30
L1L2STAB_API L1L2StabResult l1l2stab_set_bypass(L1L2Stab *s, int bypass);

/* Reports the frame that pull() would return next. OK: *pts and *opaque are set (each pointer may be NULL). Otherwise
 * nothing is set, and the result is that of pull(). */
L1L2STAB_API L1L2StabResult l1l2stab_peek(const L1L2Stab *s, int64_t *pts, void **opaque);

/* Renders the oldest frame that is ready into the caller's planes, and releases it, or with L1L2STAB_BORDER_FILL the
 * one `fill_frames` before it.
 * out: struct_size, data and stride are read, pts and opaque are set (opaque of a frame that was released is no longer
 * valid); NULL: nothing is rendered, for callers who want the numbers alone. info: may be NULL.
 * AGAIN: push more, or finish. EOS: finished, and every frame has been pulled. An error is the caller's alone (out
 * lacks a plane, or the frame was pushed without pixels): the frame remains queued. */
L1L2STAB_API L1L2STAB_MUST_CHECK L1L2StabResult l1l2stab_pull(L1L2Stab *s, L1L2StabFrame *out, L1L2StabInfo *info);

/* Writes to `map` who gave each pixel of the frame that was pulled last with `out`: one byte a pixel, `stride` bytes
 * from row to row. 0: the frame itself; 128 + k: the frame k frames later (before, if k < 0); 255: it was extended.
 * ERR_STATE: no frame was rendered since create or reset, or border is CROP. */
L1L2STAB_API L1L2StabResult l1l2stab_border_map(const L1L2Stab *s, uint8_t *map, ptrdiff_t stride);

/* Ends the input: held frames can be pulled until EOS, and reset() makes push() possible again. Always OK unless s is
 * NULL; calling it again does nothing. */
L1L2STAB_API L1L2StabResult l1l2stab_finish(L1L2Stab *s);

/* For a source that is late: the `frames` oldest held frames (all, if fewer are held) can be pulled from now on. Their
 * path is computed from the frames that have been pushed so far, with a shorter look-ahead. It continues the path of
 * the frames before smoothly, and stays inside the source. Frames that are pushed later wait for their whole window
 * again. A call that has to compute a path takes the time of a solve. 0 does nothing. ERR_ARGUMENT: frames < 0. */
L1L2STAB_API L1L2StabResult l1l2stab_hurry(L1L2Stab *s, int frames);

/* Drops everything held (releasing it) and forgets frames, path and pending error. What the caller set stays: the
 * config, and lambda, crop ratio and bypass as they were set last. They are in full effect from the first frame on,
 * without a gradual change. So the output is that of a new instance on which the same setters were called before the
 * first push. */
L1L2STAB_API void l1l2stab_reset(L1L2Stab *s);

/* Frees the instance (releasing what is held) and sets *s to NULL; NULL and &NULL are fine. */
L1L2STAB_API void l1l2stab_free(L1L2Stab **s);

/* One line about a result: whose fault it is and what to do. Never NULL, never to be freed. */
L1L2STAB_API const char *l1l2stab_strerror(L1L2StabResult result);

/* How many threads work on a frame, including the caller's; 0 for NULL. */
L1L2STAB_API int l1l2stab_threads(const L1L2Stab *s);

/* The instruction set that the warp's inner loops use on this processor: "avx2", "neon", or "none" for plain C. The
 * pictures are the same. Never NULL, never to be freed. */
L1L2STAB_API const char *l1l2stab_simd(void);

/* "major.minor.patch" of the library that runs. Never to be freed. */
L1L2STAB_API const char *l1l2stab_version(void);

#ifdef __cplusplus
}
#endif

#endif /* L1L2STAB_H */
