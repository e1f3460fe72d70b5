/* SPDX-License-Identifier: MIT */
/*
 * Synthetic clips whose camera motion is known exactly. A camera that pans and shakes films a textured, periodic scene.
 * Clips can have most of what makes real footage hard. Deterministic: the same config gives the same pixels and the
 * same truth. Frames t >= 0 can be rendered in any order. A field that is zero in the config has no effect on the clip.
 *
 * Conventions are the public header's: pixels, origin at the frame's center, x right, y down, 3x3 row-major. The scene
 * is in pixels too, so a larger frame shows more of it. It repeats every SYNTH_SCENE_PX.
 */
#ifndef SYNTH_H
#define SYNTH_H

#include <l1l2stab/l1l2stab.h>
#include <stdbool.h>

#define SYNTH_SCENE_PX 1024
#define SYNTH_MAX_EVENTS 8
#define SYNTH_MAX_MOVERS 12

/* How the camera is held, which gives the spectrum of the shake. */
typedef enum SynthHold {
    SYNTH_HAND = 0, /* 0.6 to 7 Hz; higher frequencies are weaker */
    SYNTH_STAND,    /* standing still: slow sway, half as strong with each octave, and a trace of tremor */
    SYNTH_WALK,     /* two steps a second and their harmonics: the camera bobs, sways and rolls with them */
    SYNTH_VEHICLE   /* slow sway, and a rattle of 10 to 20 Hz */
} SynthHold;

/* What happens in a clip. It concerns the frames [from, from + frames) unless a line says otherwise. */
typedef enum SynthEventKind {
    SYNTH_NONE = 0,
    SYNTH_CUT,      /* `from` is the first frame of another shot; `frames` is ignored */
    SYNTH_DISSOLVE, /* into another shot */
    SYNTH_FADE_OUT, /* to black, and it stays black */
    SYNTH_FADE_IN,  /* from black */
    SYNTH_BLACK,    /* black frames */
    SYNTH_FLASH,    /* a mix with white: `amount` 1 is all white */
    SYNTH_COVER,    /* a hand moves in front of the lens and away again */
    SYNTH_GAIN,     /* luma is multiplied by `amount`: 0.1 is dark */
    SYNTH_RAMP,     /* the gain changes from 1 to `amount`, and stays there */
    SYNTH_FLICKER,  /* the gain oscillates by +-`amount` about 1, at 6 Hz */
    SYNTH_BLUR,     /* out of focus: a disc of `amount` px across */
    SYNTH_FREEZE    /* the frame before them is repeated */
} SynthEventKind;

typedef struct SynthEvent {
    SynthEventKind kind;
    int from, frames;
    double amount;
} SynthEvent;

/* What is drawn over the scene and never moves. */
enum {
    SYNTH_OVERLAY_LOGO = 1 << 0,    /* bottom right, an eighth of the width */
    SYNTH_OVERLAY_TIMECODE = 1 << 1 /* top left: the frame's number; its digits change */
};

typedef struct SynthConfig {
    int width, height;    /* pixels */
    double fps;           /* frames a second; the shake is defined in Hz */
    double pan_x, pan_y;  /* the camera's steady motion, px/frame */
    double shake;         /* rms of the shake of each axis, px */
    double roll;          /* rms of the shake of the roll, rad */
    double zoom;          /* rms of the shake of the zoom, as a ratio: 0.02 is about +-2 % */
    double noise;         /* sigma of the luma noise, gray levels */
    double foreground;    /* part of the frame that objects with a motion of their own cover, [0, 0.75] */
    L1L2StabChromaSite chroma_site;
    uint64_t seed;        /* of the scene, the shake and the noise */
    double turn;          /* the camera's steady roll, rad/frame */
    double vibration;     /* amplitude of a vibration of each axis, px */
    double vibration_roll; /* the same of the roll, rad */
    double vibration_hz;
    double readout;       /* rolling shutter: from the first row's time to the last row's, s; 0: all rows at once */
    SynthHold hold;
    int movers;           /* 0: the foreground is a disc that sways in front of the lens. 1: one ellipse that moves in
                           * the scene, about the frame's middle. 2..SYNTH_MAX_MOVERS: walkers that come and go */
    double mover_speed;   /* of the movers in the scene, px/frame; of a single one: the maximum */
    double mover_x;       /* of a single mover: its mean position, widths from the middle */
    double parallax;      /* there are nearer layers, which move up to 1 + parallax times as far as the scene */
    double exposure;      /* how long the shutter is open, frames: motion blur */
    double letterbox, pillarbox; /* part of the height or of the width that black bars take */
    unsigned overlay;     /* SYNTH_OVERLAY_* */
    int repeat_every;     /* n > 1: every n-th frame repeats the one before it; 5: 24 frames/s shown at 30 */
    bool fresh_noise;     /* repeated frames have new noise */
    double coding;        /* step to which levels are rounded, differently in each frame and block; gray levels */
    SynthEvent event[SYNTH_MAX_EVENTS];
} SynthConfig;

typedef struct Synth Synth;

/* 640x360, 30 frames/s, 4 px of shake, 0.005 rad of roll, seed 1, and nothing else. */
SynthConfig synth_defaults(void);

/* Never NULL: aborts when out of memory. */
Synth *synth_new(const SynthConfig *cfg);
void synth_free(Synth *s);

/* M_t: the map from frame t to the scene's farthest layer. With a rolling shutter it is that of the middle row. */
void synth_camera(const Synth *s, int t, double M[9]);

/* The same map at any time, in frames, which may be negative. */
void synth_camera_at(const Synth *s, double frames, double M[9]);

/* The time at which the row that lies y px below the center of frame t was taken, in frames: t + readout fps y /
 * height. If frame t repeats another one, it is that frame's time. The time of a chroma row follows from its own y. */
double synth_row_time(const Synth *s, int t, double y);

/* F_t = M_{t-1}^-1 M_t: frame t to frame t-1; the identity for t = 0. */
void synth_motion(const Synth *s, int t, double F[9]);

/* The number of the shot that most of frame t shows, from 0. All shots have the same camera path. */
int synth_shot(const Synth *s, int t);

/* The part of the scene's contrast that frame t has, [0, 1]: 0 if the frame is black, white or covered, or shows two
 * scenes. */
double synth_contrast(const Synth *s, int t);

/* Frame t at the config's size. data, stride: as in L1L2StabFrame. */
void synth_render(const Synth *s, int t, L1L2StabFormat format, uint8_t *const data[4], const ptrdiff_t stride[4]);
void synth_render_gray(const Synth *s, int t, uint8_t *data, ptrdiff_t stride);

/* The same picture in 10 bits, in the low bits of two bytes each; stride in bytes. */
void synth_render_gray10(const Synth *s, int t, uint16_t *data, ptrdiff_t stride);

/* The first shot as a camera at M would film it, at any size: the picture that a perfect warp would make. It has no
 * noise, foreground, overlay or event. */
void synth_render_view(const Synth *s, const double M[9], int width, int height, L1L2StabFormat format,
                       uint8_t *const data[4], const ptrdiff_t stride[4]);

/* A picture's memory, planes one after the other and rows without padding. */
typedef struct SynthPicture {
    L1L2StabFormat format;
    int width, height;  /* pixels */
    int planes;
    int rows[4];        /* of each plane */
    uint8_t *data[4];   /* data[0] is the start of the memory */
    ptrdiff_t stride[4];
    size_t size;        /* bytes in all */
} SynthPicture;

/* Zeroed. Aborts on an unknown format or when out of memory. */
SynthPicture synth_picture_new(L1L2StabFormat format, int width, int height);
void synth_picture_free(SynthPicture *p);

#endif
