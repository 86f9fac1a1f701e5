MODULE CATSABB
  ! catseye: moves the robot on the orders of a PC, one after the other.
  ! Started by the operator, or by the PC after a stop, from main in AUTO and left running.
  ! An order is carried out once: cats_seq is its number, cats_taken and cats_done answer with it.
  ! The robot stops 0.4 to 0.5 s after the last change of cats_beat; a stop of RAPID stops it at once.

  ! of this file; the PC moves nothing with others
  PERS num cats_version := 1;

  ! the tool as it is mounted, with its mass and centre of gravity: set it before anything moves
  PERS tooldata cats_tool := [TRUE,[[0,0,0],[1,0,0,0]],[0.001,[0,0,0.001],[1,0,0,0],0,0,0]];

  ! written by the PC; cats_seq last, since an order begins with it
  PERS num cats_seq := 0;
  PERS num cats_for := 0;
  PERS jointtarget cats_goal := [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS num cats_beat := 0;

  ! written by the program
  PERS num cats_taken := 0;
  PERS num cats_done := 0;
  PERS num cats_result := 0;

  VAR intnum cats_tick;
  VAR num cats_heard := 0;
  VAR num cats_missed := 0;
  VAR errnum CATS_SILENT := -1;

  PROC main()
    BookErrNo CATS_SILENT;
    IDelete cats_tick;
    ! an order from before the start is not carried out
    cats_taken := cats_seq;
    cats_done := cats_seq;
    WHILE TRUE DO
      WaitUntil cats_seq <> cats_taken \PollRate:=0.04;
      cats_take cats_seq;
    ENDWHILE
  ENDPROC

  PROC cats_take(num number)
    ! results: 0 done, 1 under way, 2 not prepared, 3 heartbeat ended
    ! first it is taken, then looked at: what the PC takes back (cats_for) is refused here, or the PC sees it taken
    cats_result := 1;
    cats_taken := number;
    IF cats_for = number THEN
      cats_move;
    ELSE
      cats_result := 2;
    ENDIF
    cats_done := number;
  ENDPROC

  PROC cats_move()
    VAR jointtarget goal;
    ! external axes stay where they are
    goal := CJointT();
    goal.robax := cats_goal.robax;
    cats_heard := cats_beat;
    cats_missed := 0;
    IDelete cats_tick;
    CONNECT cats_tick WITH cats_listen;
    ITimer 0.1, cats_tick;
    ! fine: the next instruction is reached when the robot stands
    MoveAbsJ goal, vmax, fine, cats_tool;
    IDelete cats_tick;
    cats_result := 0;
  ERROR (CATS_SILENT)
    cats_result := 3;
    RETURN;
  ENDPROC

  TRAP cats_listen
    IF cats_beat <> cats_heard THEN
      cats_heard := cats_beat;
      cats_missed := 0;
    ELSE
      cats_missed := cats_missed + 1;
    ENDIF
    IF cats_missed >= 4 THEN
      IDelete cats_tick;
      StopMove \Quick;
      ClearPath;
      StartMove;
      RAISE CATS_SILENT;
    ENDIF
  ERROR
    RAISE;
  ENDTRAP
ENDMODULE
