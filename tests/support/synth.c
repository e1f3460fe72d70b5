/* SPDX-License-Identifier: MIT */
/*
 * The renderer: for each run of samples, what the lens shows (synth_view), what the sensor makes of it (synth_sensor),
 * what is drawn over it (synth_overlay), and where it goes in memory (synth_picture).
 */
#include "synth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "synth_overlay.h"
#include "synth_path.h"
#include "synth_picture.h"
#include "synth_scene.h"
#include "synth_sensor.h"
#include "synth_timeline.h"
#include "synth_view.h"

struct Synth {
    SynthConfig cfg;
    SynthScene scene[2]; /* of even and odd shots; the second one only if there is a second shot */
    SynthSensor sensor;
};

typedef struct Frame {
    const Synth *s;
    int width, height; /* pixels */
    int t;             /* -1: the camera's picture alone, without events, noise or overlay */
    SynthMoment moment;
    SynthView view;    /* of the row that is rendered */
} Frame;

SynthConfig synth_defaults(void)
{
    return (SynthConfig){.width = 640, .height = 360, .fps = 30.0, .shake = 4.0, .roll = 0.005, .seed = 1};
}

Synth *synth_new(const SynthConfig *cfg)
{
    Synth *s = synth_alloc(1, sizeof *s);
    s->cfg = *cfg;
    synth_scene_init(&s->scene[0], cfg->seed, cfg->parallax > 0.0);
    if (synth_timeline_cuts(cfg))
        synth_scene_init(&s->scene[1], ~cfg->seed, cfg->parallax > 0.0);
    synth_sensor_init(&s->sensor, cfg);
    return s;
}

void synth_free(Synth *s)
{
    if (!s)
        return;
    synth_scene_clear(&s->scene[0]);
    synth_scene_clear(&s->scene[1]);
    synth_sensor_clear(&s->sensor);
    free(s);
}

void synth_camera_at(const Synth *s, double frames, double M[9])
{
    synth_path_pose(&s->cfg, frames, M);
}

void synth_camera(const Synth *s, int t, double M[9])
{
    synth_camera_at(s, synth_timeline_at(&s->cfg, t).time, M);
}

static double row_time(const SynthConfig *cfg, const SynthMoment *moment, double y)
{
    return moment->time + cfg->readout * cfg->fps * y / cfg->height;
}

double synth_row_time(const Synth *s, int t, double y)
{
    const SynthMoment moment = synth_timeline_at(&s->cfg, t);
    return row_time(&s->cfg, &moment, y);
}

void synth_motion(const Synth *s, int t, double F[9])
{
    double M[9], N[9];
    synth_camera(s, t, M);
    synth_camera(s, t > 0 ? t - 1 : 0, N);
    synth_path_motion(M, N, F);
}

int synth_shot(const Synth *s, int t)
{
    const SynthMoment moment = synth_timeline_at(&s->cfg, t);
    return moment.shot + (moment.mix > 0.5);
}

double synth_contrast(const Synth *s, int t)
{
    const SynthMoment m = synth_timeline_at(&s->cfg, t);
    const double open = 1.0 - m.cover; /* squared: less of the area is open, and all of that is on one side */
    return m.mix > 0.0 ? 0.0 : fmin(m.gain, 1.0) * (1.0 - m.white) * (1.0 - m.black) * open * open;
}

/* A dissolve shows two scenes. */
static void mix(const Frame *f, const SynthSpan *span, uint16_t *deep)
{
    uint16_t next[SYNTH_SPAN];
    synth_view_draw(&f->view, &f->s->scene[(f->moment.shot + 1) % 2], span, next);
    for (int i = 0; i < span->count; i++)
        deep[i] = (uint16_t)(deep[i] + (next[i] - deep[i]) * f->moment.mix + 0.5);
}

static void render_span(const Frame *f, int depth, const SynthSpan *span, uint16_t *code)
{
    static const SynthSensor noiseless = {0};
    uint16_t deep[SYNTH_SPAN];
    synth_view_draw(&f->view, &f->s->scene[f->moment.shot % 2], span, deep);
    if (f->moment.mix > 0.0)
        mix(f, span, deep);
    synth_sensor_expose(&f->moment, f->width, span, deep);
    const int grain = f->s->cfg.fresh_noise ? f->t : f->moment.taken;
    synth_sensor_read(f->t < 0 ? &noiseless : &f->s->sensor, f->t, grain, depth, span, deep, code);
    if (f->t >= 0)
        synth_overlay_draw(&f->s->cfg, f->t, depth, span, code);
}

/* Every row has the camera of its own time. */
static void aim(Frame *f, double y)
{
    const SynthConfig *cfg = &f->s->cfg;
    if (f->t >= 0 && cfg->readout > 0.0)
        synth_view_aim(&f->view, cfg, row_time(cfg, &f->moment, y), f->moment.blur);
}

static void render_plane(Frame *f, const SynthLayout *layout, int plane, uint8_t *data, ptrdiff_t stride)
{
    const int sx = plane ? layout->sub_x : 0, sy = plane ? layout->sub_y : 0;
    const int columns = (f->width + sx) >> sx, rows = (f->height + sy) >> sy;
    const SynthAxis ax = synth_axis_x(layout, plane, f->s->cfg.chroma_site);
    const SynthAxis ay = synth_axis_y(layout, plane, f->s->cfg.chroma_site);
    const int components = layout->packed ? 3 : layout->second[plane] < 0 ? 1 : 2;
    for (int j = 0; j < rows; j++) {
        const double y = j * ay.step + ay.offset - 0.5 * f->height;
        uint8_t *row = data + j * stride;
        aim(f, y);
        for (int i = 0; i < columns; i += SYNTH_SPAN) {
            SynthSpan span = {0, i, j, columns - i < SYNTH_SPAN ? columns - i : SYNTH_SPAN,
                              i * ax.step + ax.offset - 0.5 * f->width, y, ax.step};
            uint16_t code[3][SYNTH_SPAN];
            for (int k = 0; k < components; k++) {
                span.component = layout->packed ? k : k ? layout->second[plane] : layout->first[plane];
                render_span(f, layout->depth, &span, code[k]);
                if (!layout->packed)
                    synth_store(layout, plane, k, &span, code[k], row);
            }
            if (layout->packed)
                synth_store_packed(layout, &span, code, row);
        }
    }
}

static void render(Frame *f, const SynthLayout *layout, uint8_t *const data[4], const ptrdiff_t stride[4])
{
    for (int p = 0; p < layout->planes; p++)
        render_plane(f, layout, p, data[p], stride[p]);
}

static void render_frame(const Synth *s, int t, const SynthLayout *layout, uint8_t *const data[4],
                         const ptrdiff_t stride[4])
{
    Frame f = {.s = s, .width = s->cfg.width, .height = s->cfg.height, .t = t};
    f.moment = synth_timeline_at(&s->cfg, t);
    synth_view_aim(&f.view, &s->cfg, f.moment.time, f.moment.blur);
    render(&f, layout, data, stride);
}

void synth_render(const Synth *s, int t, L1L2StabFormat format, uint8_t *const data[4], const ptrdiff_t stride[4])
{
    const SynthLayout layout = synth_layout_of(format);
    render_frame(s, t, &layout, data, stride);
}

void synth_render_gray(const Synth *s, int t, uint8_t *data, ptrdiff_t stride)
{
    synth_render(s, t, L1L2STAB_FORMAT_GRAY8, (uint8_t *const[4]){data}, (const ptrdiff_t[4]){stride});
}

void synth_render_gray10(const Synth *s, int t, uint16_t *data, ptrdiff_t stride)
{
    SynthLayout layout = synth_layout_of(L1L2STAB_FORMAT_GRAY8);
    layout.depth = 10;
    render_frame(s, t, &layout, (uint8_t *const[4]){(uint8_t *)data}, (const ptrdiff_t[4]){stride});
}

void synth_render_view(const Synth *s, const double M[9], int width, int height, L1L2StabFormat format,
                       uint8_t *const data[4], const ptrdiff_t stride[4])
{
    const SynthLayout layout = synth_layout_of(format);
    Frame f = {.s = s, .width = width, .height = height, .t = -1, .moment = {.gain = 1.0}};
    synth_view_aim_at(&f.view, &s->cfg, M);
    render(&f, &layout, data, stride);
}
