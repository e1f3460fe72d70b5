/* SPDX-License-Identifier: MIT */
#include "path/path.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/mem.h"
#include "path/constraints.h"
#include "path/coverage.h"
#include "path/solver.h"
#include "path/window_schedule.h"

_Static_assert(L1L2_PATH_HISTORY <= L1L2_PATH_PAST, "a window looks back on more frames than are kept");

/* Where borders are filled: a path that leaves more than this part of a frame to be made up gives way. */
static const double most_lacking = 0.01;
/* The room that it has then, as a crop ratio, and how fast the room changes from frame to frame. */
static const double tightest_room = 0.99, room_step = 0.005;
/* Windows are solved again at most so often: where a path gives way at one side, it may come to lack another. */
enum { TIGHTENINGS = 4 };

struct L1L2Path {
    L1L2PathConfig cfg;
    double crop_ratio; /* in effect for the frame pushed last */
    L1L2PathSchedule schedule;
    int64_t start;     /* frame with which the current path starts */
    int64_t pushed, decided, pulled; /* frames since reset */
    L1L2PathProblem *problem;
    L1L2PathSolver *solver;
    double (*solution)[L1L2_DIM];
    L1L2Coverage *coverage; /* NULL: borders are not filled */
};

static L1L2PathFrame *frame_at(const L1L2Path *path, int64_t t)
{
    return l1l2_frame_column_at(path->cfg.frames, t);
}

L1L2StabResult l1l2_path_create(L1L2Path **out, const L1L2PathConfig *cfg)
{
    *out = NULL;
    assert(cfg->frames.rows >= cfg->window + L1L2_PATH_PAST && cfg->frames.rows >= cfg->window + cfg->fill_reach);
    assert(cfg->fill_reach <= L1L2_PATH_MAX_REACH);
    L1L2Path *path = l1l2_mem_new(1, sizeof *path);
    if (!path)
        return L1L2STAB_ERR_NOMEM;
    const int dim = l1l2_mat_dim(cfg->model);
    path->cfg = *cfg;
    path->problem = l1l2_path_problem_create(cfg->window, dim);
    path->solver = l1l2_path_solver_create(cfg->window, dim);
    path->solution = l1l2_mem_new((size_t)cfg->window, sizeof *path->solution);
    if (cfg->fill_reach > 0)
        path->coverage = l1l2_mem_new(1, sizeof *path->coverage);
    if (!path->problem || !path->solver || !path->solution || (cfg->fill_reach > 0 && !path->coverage)) {
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
    l1l2_path_problem_free(path->problem);
    l1l2_path_solver_free(path->solver);
    l1l2_mem_free(path->solution);
    l1l2_mem_free(path->coverage);
    l1l2_mem_free(path);
}

void l1l2_path_reset(L1L2Path *path)
{
    path->start = path->pushed = path->decided = path->pulled = 0;
    path->schedule = l1l2_path_schedule_start(path->cfg.window, path->cfg.overlap);
}

static L1L2PathCropWindow crop_of(const L1L2Path *path, const L1L2PathFrame *frame)
{
    return l1l2_path_crop_window(path->cfg.width, path->cfg.height, frame->room_ratio, path->problem->dim);
}

/* How many frames of a window are averaged with the window before it. If none, the join is continuous. */
static int blended(const L1L2Path *path, const L1L2PathWindow *step)
{
    return path->cfg.join == L1L2STAB_JOIN_BLEND ? step->shared : 0;
}

/* The steps of a frame and of the two before it. Those before the path's start count as one frame. */
static void steps_of(const L1L2Path *path, int64_t frame, double step[L1L2_PATH_HISTORY])
{
    for (int back = 0; back < L1L2_PATH_HISTORY; back++)
        step[back] = frame - back > path->start ? frame_at(path, frame - back)->step : 1.0;
}

/* The time that frame t of a window stands for, nominal frames. The step after the window's last frame counts as one
 * frame, because the frame after it may not have come yet. */
static double share_of_time(const L1L2Path *path, const L1L2PathWindow *step, int t)
{
    const int64_t frame = path->start + step->first + t;
    return 0.5 * (frame_at(path, frame)->step + (t + 1 < step->count ? frame_at(path, frame + 1)->step : 1.0));
}

/* eq. (1): C of the window's frames, relative to the first of them, with their weights and constraints. */
static void set_camera_path(L1L2Path *path, const L1L2PathWindow *step)
{
    L1L2PathProblem *p = path->problem;
    const int64_t first = path->start + step->first;
    const double rate = path->cfg.frame_rate > 0.0 ? path->cfg.frame_rate : 30.0;
    L1L2Mat camera = l1l2_mat_identity();
    p->count = step->count;
    for (int t = 0; t < step->count; t++) {
        const L1L2PathFrame *frame = frame_at(path, first + t);
        const L1L2PathCropWindow crop = crop_of(path, frame);
        if (t > 0)
            camera = l1l2_mat_mul(camera, frame->F);
        double steps[L1L2_PATH_HISTORY];
        steps_of(path, first + t, steps);
        l1l2_path_problem_set(p, t, &camera, frame->lambda * 30.0 / rate * share_of_time(path, step, t), &crop);
        l1l2_path_problem_set_steps(p, t, steps);
    }
}

/* For a continuous join: P of the three frames before the window, in the same reference. */
static void set_history(L1L2Path *path, const L1L2PathWindow *step)
{
    L1L2PathProblem *p = path->problem;
    const int64_t first = path->start + step->first;
    L1L2Mat camera = l1l2_mat_identity();
    p->history = 0;
    if (blended(path, step) > 0)
        return;
    for (int back = 1; back <= L1L2_PATH_HISTORY && back <= step->first; back++) {
        L1L2Mat inverse;
        l1l2_mat_inverse(frame_at(path, first - back + 1)->F, &inverse);
        camera = l1l2_mat_mul(camera, inverse);
        const L1L2Mat smooth = l1l2_mat_mul(camera, frame_at(path, first - back)->B);
        l1l2_mat_to_q(&smooth, p->past[L1L2_PATH_HISTORY - back]);
        p->history = back;
    }
}

/* The path if no solver converges: it continues at the last speed, which decays, and is corrected to satisfy each
 * frame's constraints. It is feasible, and continuous with the frames that were emitted, but not smooth. */
static void hold_course(L1L2Path *path, const L1L2PathWindow *step)
{
    const double fade = 0.95;
    const int64_t first = path->start + step->first;
    L1L2Mat B = step->first > 0 ? frame_at(path, first - 1)->B : l1l2_mat_identity();
    double speed_x = 0.0, speed_y = 0.0;
    if (step->first > 0)
        speed_x = frame_at(path, first - 1)->S.m[2] / frame_at(path, first - 1)->step,
        speed_y = frame_at(path, first - 1)->S.m[5] / frame_at(path, first - 1)->step;
    for (int t = 0; t < step->count; t++) {
        if (step->first + t > 0) {
            const L1L2PathFrame *frame = frame_at(path, first + t);
            const L1L2PathCropWindow crop = crop_of(path, frame);
            L1L2Mat inverse; /* P_t = P_{t-1} S, so B_t = F_t^-1 B_{t-1} S */
            l1l2_mat_inverse(frame->F, &inverse);
            const L1L2Mat smooth = l1l2_mat_translation(frame->step * speed_x, frame->step * speed_y);
            B = l1l2_mat_mul(l1l2_mat_mul(inverse, B), smooth);
            B = l1l2_path_constraint_shrink(&crop, &B);
        }
        speed_x *= fade, speed_y *= fade;
        frame_at(path, first + t)->next_B = B;
    }
}

/* eq. (2), B_t = C_t^-1 P_t for the frames of the window. A B_t that the solver's tolerance left outside is moved
 * inside. */
static void update_transforms(L1L2Path *path, const L1L2PathWindow *step)
{
    const L1L2PathProblem *p = path->problem;
    for (int t = 0; t < step->count; t++) {
        const L1L2Mat camera = l1l2_mat_from_q(p->camera[t], p->dim);
        const L1L2Mat smooth = l1l2_mat_from_q(path->solution[t], p->dim);
        L1L2PathFrame *frame = frame_at(path, path->start + step->first + t);
        const L1L2PathCropWindow crop = crop_of(path, frame);
        L1L2Mat inverse;
        l1l2_mat_inverse(camera, &inverse);
        const L1L2Mat B = l1l2_mat_mul(inverse, smooth);
        frame->next_B = l1l2_path_constraint_shrink(&crop, &B);
    }
}

/* eq. (8) with the corrected weights of path.h. P = C B is linear in B for one camera path, so averaging B averages
 * P. */
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
        L1L2PathFrame *f = frame_at(path, frame);
        f->B = t < shared ? blend(&f->B, &f->next_B, t + 1, shared) : f->next_B;
        f->S = l1l2_mat_identity();
        if (frame > path->start) {
            L1L2Mat inverse;
            l1l2_mat_inverse(frame_at(path, frame - 1)->B, &inverse);
            f->S = l1l2_mat_mul(l1l2_mat_mul(inverse, f->F), f->B);
        }
        f->early = step->early;
        f->fallback = !report->converged;
        f->report = *report;
    }
    for (int t = step->emit; t < step->count; t++) {
        L1L2PathFrame *frame = frame_at(path, path->start + step->first + t);
        frame->B = frame->next_B; /* what the next window blends with */
    }
    path->decided = path->start + step->first + step->emit;
}

/* If no solver converged, the predictor's point is still used where its bound shows that it is close to the optimum.
 * Otherwise hold_course() makes the path. */
static L1L2PathSolverReport solve_once(L1L2Path *path, const L1L2PathWindow *step)
{
    const double near_enough = 1e-4;
    set_camera_path(path, step);
    set_history(path, step);
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
    return report;
}

/* What the neighbors of a frame show. False if some of them have not come yet: more may be covered then. */
static bool set_coverage(L1L2Path *path, const L1L2PathWindow *step, int64_t frame)
{
    const bool ended = step->emit == step->count || step->early;
    const int64_t end = path->start + step->first + step->count;
    const int reach = path->cfg.fill_reach;
    const double diagonal = hypot(path->cfg.width, path->cfg.height);
    L1L2Coverage *coverage = path->coverage;
    coverage->half_w = path->cfg.width / (2.0 * diagonal);
    coverage->half_h = path->cfg.height / (2.0 * diagonal);
    coverage->margin = path->cfg.fill_margin;
    coverage->count = l1l2_path_chain(path->cfg.frames, frame, path->start, end, reach, coverage->neighbor);
    return ended || frame + reach < end;
}

/* The room changes slowly beside a frame. */
static void follow(L1L2PathFrame *frame, const L1L2PathFrame *beside)
{
    frame->room_ratio = fmax(frame->room_ratio, beside->room_ratio - room_step);
}

/* Gives less room to the frames of a window that lack too much, and to those around them. False if there are none. */
static bool tighten(L1L2Path *path, const L1L2PathWindow *step)
{
    const int64_t first = path->start + step->first, end = first + step->count;
    bool any = false;
    for (int64_t t = first; t < end; t++) {
        L1L2PathFrame *frame = frame_at(path, t);
        if (!set_coverage(path, step, t))
            continue;
        const double ratio =
            l1l2_coverage_ratio(path->coverage, &frame->next_B, frame->room_ratio, most_lacking, tightest_room);
        any = any || ratio > frame->room_ratio;
        frame->room_ratio = ratio;
    }
    for (int64_t t = first + 1; any && t < end; t++)
        follow(frame_at(path, t), frame_at(path, t - 1));
    for (int64_t t = end - 2; any && t >= first; t--)
        follow(frame_at(path, t), frame_at(path, t + 1));
    return any;
}

static void solve_window(L1L2Path *path, const L1L2PathWindow *step)
{
    for (int t = 0; t < step->count; t++) {
        L1L2PathFrame *frame = frame_at(path, path->start + step->first + t);
        frame->room_ratio = frame->crop_ratio;
    }
    L1L2PathSolverReport report = solve_once(path, step);
    for (int i = 0; path->coverage && i < TIGHTENINGS && tighten(path, step); i++)
        report = solve_once(path, step);
    decide(path, step, &report);
}

/* Solves every window that can be solved. */
static void advance(L1L2Path *path, bool ended)
{
    L1L2PathWindow step;
    while (l1l2_path_schedule_next(&path->schedule, path->pushed - path->start, ended, &step))
        solve_window(path, &step);
}

/* The crop ratio of the next frame: at most one step closer to the one that is wanted. */
static double step_crop_ratio(const L1L2Path *path, const L1L2PathInput *input, bool starts_path)
{
    const double change = input->crop_ratio - path->crop_ratio;
    if (starts_path || fabs(change) <= L1L2_CROP_STEP)
        return input->crop_ratio;
    return path->crop_ratio + copysign(L1L2_CROP_STEP, change);
}

/* The motion as a map of the path's model; the identity if F is not finite or not invertible. */
static L1L2Mat usable_motion(const L1L2Path *path, const L1L2Mat *F)
{
    const L1L2Mat motion = l1l2_mat_reduce(F, path->problem->dim);
    L1L2Mat inverse;
    return l1l2_mat_is_finite(F) && l1l2_mat_inverse(motion, &inverse) ? motion : l1l2_mat_identity();
}

void l1l2_path_push(L1L2Path *path, const L1L2PathInput *input)
{
    assert(path->pushed - path->pulled < path->cfg.window);
    const bool starts_path = input->starts_path || path->pushed == 0;
    if (starts_path) {
        advance(path, true);
        path->start = path->pushed;
        path->schedule = l1l2_path_schedule_start(path->cfg.window, path->cfg.overlap);
    }
    path->crop_ratio = step_crop_ratio(path, input, starts_path);
    *frame_at(path, path->pushed) = (L1L2PathFrame){
        .F = starts_path ? l1l2_mat_identity() : usable_motion(path, input->F),
        .lambda = input->lambda,
        .crop_ratio = path->crop_ratio,
        .room_ratio = path->crop_ratio,
        .linked = !starts_path && !input->lost,
        .step = starts_path || input->step == 0.0 ? 1.0 : input->step,
        .path_index = (uint64_t)(path->pushed - path->start),
    };
    path->pushed++;
    advance(path, false);
}

int l1l2_path_undecided(const L1L2Path *path)
{
    return (int)(path->pushed - path->decided);
}

L1L2Mat l1l2_path_motion(const L1L2Path *path, int back)
{
    return frame_at(path, path->pushed - 1 - back)->F;
}

void l1l2_path_amend(L1L2Path *path, int back, const L1L2Mat *F)
{
    const int64_t frame = path->pushed - 1 - back;
    assert(back >= 0 && frame >= path->decided);
    if (frame > path->start)
        frame_at(path, frame)->F = usable_motion(path, F);
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

const L1L2PathFrame *l1l2_path_pull(L1L2Path *path)
{
    return path->pulled == path->decided ? NULL : frame_at(path, path->pulled++);
}
