/* SPDX-License-Identifier: MIT */
#include "path/path.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/mem.h"
#include "path/constraints.h"
#include "path/solver.h"
#include "path/window_schedule.h"

typedef struct Slot {
    L1L2PathFrame frame;
    L1L2Mat next_B; /* the B that an older window found for a frame it did not give out; blend joins with it */
} Slot;

struct L1L2Path {
    L1L2PathConfig cfg;
    double crop_ratio; /* of the frame pushed last, on the way to cfg's */
    L1L2PathSchedule schedule;
    Slot *slots;      /* frame t is at t modulo capacity */
    int capacity;     /* window + the three frames that a window looks back on */
    int64_t start;    /* frame with which the current path starts */
    int64_t pushed, decided, pulled; /* frames since reset */
    L1L2PathProblem *problem;
    L1L2PathSolver *solver;
    double (*solution)[L1L2_DIM];
};

static Slot *slot(L1L2Path *path, int64_t t)
{
    return &path->slots[t % path->capacity];
}

L1L2StabResult l1l2_path_create(L1L2Path **out, const L1L2PathConfig *cfg)
{
    *out = NULL;
    L1L2Path *path = l1l2_mem_new(1, sizeof *path);
    if (!path)
        return L1L2STAB_ERR_NOMEM;
    const int dim = l1l2_mat_dim(cfg->model);
    path->cfg = *cfg;
    path->capacity = cfg->window + L1L2_PATH_HISTORY + 1;
    path->slots = l1l2_mem_new((size_t)path->capacity, sizeof *path->slots);
    path->problem = l1l2_path_problem_create(cfg->window, dim);
    path->solver = l1l2_path_solver_create(cfg->window, dim);
    path->solution = l1l2_mem_new((size_t)cfg->window, sizeof *path->solution);
    if (!path->slots || !path->problem || !path->solver || !path->solution) {
        l1l2_path_free(path);
        return L1L2STAB_ERR_NOMEM;
    }
    memcpy(path->problem->weight, cfg->weights, sizeof cfg->weights);
    l1l2_path_reset(path);
    *out = path;
    return L1L2STAB_OK;
}

void l1l2_path_free(L1L2Path *path)
{
    if (!path)
        return;
    l1l2_mem_free(path->slots);
    l1l2_path_problem_free(path->problem);
    l1l2_path_solver_free(path->solver);
    l1l2_mem_free(path->solution);
    l1l2_mem_free(path);
}

void l1l2_path_reset(L1L2Path *path)
{
    path->start = path->pushed = path->decided = path->pulled = 0;
    path->schedule = l1l2_path_schedule_start(path->cfg.window, path->cfg.overlap);
    path->crop_ratio = path->cfg.crop_ratio;
}

void l1l2_path_set_lambda(L1L2Path *path, double lambda)
{
    path->cfg.lambda = lambda;
}

void l1l2_path_set_crop_ratio(L1L2Path *path, double crop_ratio)
{
    path->cfg.crop_ratio = crop_ratio;
}

static L1L2PathCropWindow crop_of(const L1L2Path *path, const L1L2PathFrame *frame)
{
    return l1l2_path_crop_window(path->cfg.width, path->cfg.height, frame->crop_ratio, path->problem->dim);
}

/* The frames of a window that are averaged with the window before it. Where there are none the join is continuous. */
static int blended(const L1L2Path *path, const L1L2PathWindow *step)
{
    return path->cfg.join == L1L2STAB_JOIN_BLEND ? step->shared : 0;
}

/* eq. (1), relative to the window's first frame: C of the frames of the window, and P of the three before it. */
static void describe_window(L1L2Path *path, const L1L2PathWindow *step)
{
    L1L2PathProblem *p = path->problem;
    const int64_t first = path->start + step->first;
    const double rate = path->cfg.frame_rate > 0.0 ? path->cfg.frame_rate : 30.0;
    L1L2Mat camera = l1l2_mat_identity();
    p->count = step->count;
    for (int t = 0; t < step->count; t++) {
        const L1L2PathFrame *frame = &slot(path, first + t)->frame;
        const L1L2PathCropWindow crop = crop_of(path, frame);
        if (t > 0)
            camera = l1l2_mat_mul(camera, frame->F);
        l1l2_path_problem_set(p, t, &camera, frame->lambda * 30.0 / rate, &crop);
    }
    p->history = 0;
    if (blended(path, step) > 0)
        return;
    camera = l1l2_mat_identity();
    for (int back = 1; back <= L1L2_PATH_HISTORY && back <= step->first; back++) {
        L1L2Mat inverse;
        l1l2_mat_inverse(slot(path, first - back + 1)->frame.F, &inverse);
        camera = l1l2_mat_mul(camera, inverse);
        const L1L2Mat smooth = l1l2_mat_mul(camera, slot(path, first - back)->frame.B);
        l1l2_mat_to_q(&smooth, p->past[L1L2_PATH_HISTORY - back]);
        p->history = back;
    }
}

/* A path for when no solver converges: it goes on at the last speed, which fades. The constraints of each frame, met
 * one after the other, bend it. Feasible and continuous with what was given out, but not smooth. */
static void hold_course(L1L2Path *path, const L1L2PathWindow *step)
{
    const double fade = 0.95;
    const int64_t first = path->start + step->first;
    L1L2Mat B = step->first > 0 ? slot(path, first - 1)->frame.B : l1l2_mat_identity();
    double speed_x = 0.0, speed_y = 0.0;
    if (step->first > 0)
        speed_x = slot(path, first - 1)->frame.S.m[2], speed_y = slot(path, first - 1)->frame.S.m[5];
    for (int t = 0; t < step->count; t++) {
        if (step->first + t > 0) {
            const L1L2PathFrame *frame = &slot(path, first + t)->frame;
            const L1L2PathCropWindow crop = crop_of(path, frame);
            L1L2Mat inverse; /* P_t = P_{t-1} S, so B_t = F_t^-1 B_{t-1} S */
            l1l2_mat_inverse(frame->F, &inverse);
            B = l1l2_mat_mul(l1l2_mat_mul(inverse, B), l1l2_mat_translation(speed_x, speed_y));
            B = l1l2_path_constraint_shrink(&crop, &B);
        }
        speed_x *= fade, speed_y *= fade;
        slot(path, first + t)->next_B = B;
    }
}

/* eq. (2), B_t = C_t^-1 P_t for the frames of the window; what the solver's tolerance leaves outside is pulled in. */
static void update_transforms(L1L2Path *path, const L1L2PathWindow *step)
{
    const L1L2PathProblem *p = path->problem;
    for (int t = 0; t < step->count; t++) {
        const L1L2Mat camera = l1l2_mat_from_q(p->camera[t], p->dim);
        const L1L2Mat smooth = l1l2_mat_from_q(path->solution[t], p->dim);
        Slot *s = slot(path, path->start + step->first + t);
        const L1L2PathCropWindow crop = crop_of(path, &s->frame);
        L1L2Mat inverse;
        l1l2_mat_inverse(camera, &inverse);
        const L1L2Mat B = l1l2_mat_mul(inverse, smooth);
        s->next_B = l1l2_path_constraint_shrink(&crop, &B);
    }
}

/* eq. (8), weights put right (see path.h). P = C B is linear in B for one camera path, so averaging B averages P. */
static L1L2Mat blend(const L1L2Mat *old_B, const L1L2Mat *new_B, int i, int overlap)
{
    const double new_weight = (double)i / (overlap + 1);
    L1L2Mat B;
    for (int k = 0; k < 9; k++)
        B.m[k] = old_B->m[k] + new_weight * (new_B->m[k] - old_B->m[k]);
    return B;
}

static void decide(L1L2Path *path, const L1L2PathWindow *step, const L1L2PathSolverReport *report)
{
    const int shared = blended(path, step);
    for (int t = 0; t < step->emit; t++) {
        const int64_t frame = path->start + step->first + t;
        L1L2PathFrame *f = &slot(path, frame)->frame;
        f->B = t < shared ? blend(&f->B, &slot(path, frame)->next_B, t + 1, shared) : slot(path, frame)->next_B;
        f->S = l1l2_mat_identity();
        if (frame > path->start) {
            L1L2Mat inverse;
            l1l2_mat_inverse(slot(path, frame - 1)->frame.B, &inverse);
            f->S = l1l2_mat_mul(l1l2_mat_mul(inverse, f->F), f->B);
        }
        f->early = step->early;
        f->fallback = !report->converged;
        f->report = *report;
    }
    for (int t = step->emit; t < step->count; t++) {
        Slot *s = slot(path, path->start + step->first + t);
        s->frame.B = s->next_B; /* what the next window blends with */
    }
    path->decided = path->start + step->first + step->emit;
}

/* A point that is not the optimum is taken where it is near enough that nobody could tell; else the course is held. */
static void solve_window(L1L2Path *path, const L1L2PathWindow *step)
{
    const double near_enough = 1e-4;
    describe_window(path, step);
    const L1L2PathSolverReport report =
        l1l2_path_solver_solve(path->solver, path->cfg.solver, step->emit, path->problem, path->solution);
    const bool usable = report.converged || report.bound <= near_enough;
    if (usable)
        update_transforms(path, step);
    else
        hold_course(path, step);
    if (!report.converged)
        l1l2_log(path->cfg.log, L1L2STAB_LOG_WARN,
                 "path: solver did not converge on a window of %d frames (objective within %.2g of its optimum)%s",
                 step->count, report.bound, usable ? "" : ": holding a feasible path");
    decide(path, step, &report);
}

/* Solves every window that can be solved. */
static void advance(L1L2Path *path, bool ended)
{
    L1L2PathWindow step;
    while (l1l2_path_schedule_next(&path->schedule, path->pushed - path->start, ended, &step))
        solve_window(path, &step);
}

void l1l2_path_push(L1L2Path *path, const L1L2Mat *F, bool starts_path)
{
    assert(path->pushed - path->pulled < path->cfg.window);
    starts_path = starts_path || path->pushed == 0;
    if (starts_path) {
        advance(path, true);
        path->start = path->pushed;
        path->schedule = l1l2_path_schedule_start(path->cfg.window, path->cfg.overlap);
    }
    const double zoom = path->cfg.crop_ratio - path->crop_ratio;
    if (starts_path || fabs(zoom) <= L1L2_CROP_STEP)
        path->crop_ratio = path->cfg.crop_ratio;
    else
        path->crop_ratio += copysign(L1L2_CROP_STEP, zoom);
    L1L2PathFrame *f = &slot(path, path->pushed)->frame;
    f->F = l1l2_mat_identity();
    if (!starts_path) {
        const L1L2Mat motion = l1l2_mat_reduce(F, path->problem->dim);
        L1L2Mat inverse;
        if (l1l2_mat_is_finite(F) && l1l2_mat_inverse(motion, &inverse))
            f->F = motion;
    }
    f->lambda = path->cfg.lambda;
    f->crop_ratio = path->crop_ratio;
    f->path_index = (uint64_t)(path->pushed - path->start);
    path->pushed++;
    advance(path, false);
}

void l1l2_path_hurry(L1L2Path *path, int frames)
{
    const int64_t undecided = path->pulled + frames - path->decided;
    L1L2PathWindow step;
    if (l1l2_path_schedule_early(&path->schedule, path->pushed - path->start, undecided, &step))
        solve_window(path, &step);
}

void l1l2_path_finish(L1L2Path *path)
{
    advance(path, true);
}

bool l1l2_path_pull(L1L2Path *path, L1L2PathFrame *out)
{
    if (path->pulled == path->decided)
        return false;
    *out = slot(path, path->pulled++)->frame;
    return true;
}
