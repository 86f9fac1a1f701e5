' CATSDL, version 1: catseye's data link. Takes via points, drives them, tells feedback.
' Request: id,command,a,b,c,d CR   Answer: id,command,a,b,c,d CR
' 1 add a via point (deg, deg, mm, deg)   2 drive them   3 tell feedback   4 forget them
' 5 who are you   6 program override (%) and in-position pulses   7 end
Def Jnt JF
Def Inte MID,MCMD,MN,MK
Dim JQ(60)
MN=0
Fine 20
*OPENIT
Open "COM2:" As #1
*WAITC
If M_Open(1)<>1 Then GoTo *WAITC
*LOOP
Input #1,MID,MCMD,M1,M2,M3,M4
If MCMD=1 Then GoTo *ADD
If MCMD=2 Then GoTo *DRIVE
If MCMD=3 Then GoTo *TELL
If MCMD=4 Then GoTo *FORGET
If MCMD=5 Then GoTo *WHO
If MCMD=6 Then GoTo *SPEED
If MCMD=7 Then GoTo *FINISH
Print #1,MID;",-1,";MCMD;",0,0,0"
GoTo *LOOP
*ADD
If MN>=60 Then GoTo *FULL
MN=MN+1
JQ(MN)=J_Curr
JQ(MN).J1=Rad(M1)
JQ(MN).J2=Rad(M2)
JQ(MN).J3=M3
JQ(MN).J4=Rad(M4)
Print #1,MID;",1,";MN;",0,0,0"
GoTo *LOOP
*FULL
Print #1,MID;",-2,3120,0,0,0"
GoTo *LOOP
*DRIVE
If MN=0 Then GoTo *TELL
If MN=1 Then GoTo *LAST
Cnt 1
For MK=1 To MN-1
Mov JQ(MK)
Next MK
*LAST
Cnt 0
Mov JQ(MN)
Dly 0.05
MN=0
*TELL
JF=J_Fbc
M1=Deg(JF.J1)
M2=Deg(JF.J2)
M3=JF.J3
M4=Deg(JF.J4)
Print #1,MID;",";MCMD;",";M1;",";M2;",";M3;",";M4
GoTo *LOOP
*FORGET
MN=0
Print #1,MID;",4,0,0,0,0"
GoTo *LOOP
*WHO
Print #1,MID;",5,1,4,0,0"
GoTo *LOOP
*SPEED
Ovrd M1
Fine M2
Print #1,MID;",6,";M1;",";M2;",0,0"
GoTo *LOOP
*FINISH
Print #1,MID;",7,0,0,0,0"
Close #1
End
